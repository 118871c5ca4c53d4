#pragma once

#include "core/node/node_mode.hpp"
#include "core/run/fastest_mode.hpp"
#include "gpu/explicit/explicit_kernels.hpp"
#include "gpu/system/device_state.hpp"
#include "gpu/system/step_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

/// The fastest mode of a state in the memory of a space: the counterpart of core/run/explicit_mode.hpp.
namespace fascia::gpu {

namespace kernels {

/// A mode's vectors, by degrees of freedom.
struct ModeView {
  ExplicitView s;  ///< at the state
  double *y = nullptr, *v = nullptr, *w = nullptr;
  const double* base = nullptr;  ///< what acts at the state

  template <bool Frames>
  FASCIA_HD ModeNode node(int i) const {
    ModeNode n;
    n.inertia = s.m.inertia + i;
    if constexpr (Frames) {
      n.kind = s.m.nodes.kind[i];
      n.D = s.D[i];
    }
    n.turn = s.m.turn[i] < 0 ? nullptr : s.m.turns + s.m.turn[i];
    n.fixed = s.m.fixed[i];
    n.length = s.m.nodes.part_length[s.m.nodes.part[i]];
    return n;
  }
  FASCIA_HD int dof(int i) const { return s.m.nodes.dof[i]; }
};

template <bool Frames>
struct AddModeNoise {
  ModeView m;
  std::uint64_t seed;
  double each;
  FASCIA_HD void operator()(int i) const {
    const auto first = static_cast<std::uint64_t>(m.dof(i));
    add_mode_noise(m.node<Frames>(i), seed + first, each, m.y + m.dof(i));
  }
};

/// v = M⁻¹ y. Sum: v · y; largest: of the motion.
template <bool Frames>
struct SolveMass {
  ModeView m;
  FASCIA_HD void operator()(int i, Sums<1, 1>& sums) const {
    const ModeNode node = m.node<Frames>(i);
    double* v = m.v + m.dof(i);
    sums.v[0] += solve_mass(node, m.y + m.dof(i), v);
    sums.note(0, mode_size(node, v));
  }
};

struct ScaleMode {
  double *y, *v;
  double s;
  FASCIA_HD void operator()(int k) const {
    y[k] *= s;
    v[k] *= s;
  }
};

/// The state, moved along v.
template <bool Frames>
struct MoveAlong {
  ModeView m;
  double reach;
  Vec3d* u;
  Mat3d* D;
  FASCIA_HD void operator()(int i) const {
    const ModeNode node = m.node<Frames>(i);
    Vec3d moved = m.s.u[i];
    Mat3d turned = node.D;
    move_along(node, m.v + m.dof(i), reach, moved, turned);
    u[i] = moved;
    if constexpr (Frames) D[i] = turned;
  }
};

/// What acts on the nodes, with the sign of a gradient.
template <bool Frames>
struct GatherActing {
  ExplicitView s;  ///< where blocks and loads were evaluated
  double* out;
  FASCIA_HD void operator()(int i) const {
    const ExplicitNode node = s.node<Frames>(i);
    double load[kMostDofs], force[kMostDofs];
    s.forces(node, i, {}, load, force);
    for (int k = 0; k < dof_count(node.kind); ++k) out[s.m.nodes.dof[i] + k] = -force[k];
  }
};

/// w = K v. Sum: v · w.
template <bool Frames>
struct TakeDifference {
  ModeView m;
  double reach;
  FASCIA_HD void operator()(int i, Sums<1>& sums) const {
    const int first = m.dof(i);
    sums.v[0] += take_difference(m.node<Frames>(i), m.base + first, m.v + first, reach, m.w + first);
  }
};

struct NextOfBasis {
  const double *w, *y, *before;
  double a, b;
  double* next;
  FASCIA_HD void operator()(int k) const { next[k] = w[k] - a * y[k] - b * before[k]; }
};

struct CombineBasis {
  double* y[kModeBasis];
  double s[kModeBasis];
  int count;
  FASCIA_HD void operator()(int k) const {
    double sum = 0;
    for (int j = 0; j < count; ++j) sum += s[j] * y[j][k];
    y[0][k] = sum;
  }
};

}  // namespace kernels

/// An Operator of FastestMode. System: an ExplicitSystem, which has the state and its forces.
template <class Space, class System>
class ExplicitMode {
 public:
  explicit ExplicitMode(System& system) : system_(system), dofs_(system.model().dof_count()) {
    const DeviceState<Space>& pose = system.pose();
    for (auto* vector : {&base_, &v_, &w_}) vector->resize(at(dofs_));
    for (auto& y : basis_) {
      y.resize(at(dofs_));
      y.set_zero();
    }
    u_.resize(pose.u.size());
    D_.resize(pose.D.size());
    if (system.model().points.damped) E_.resize(system.strain_size());
    sums_.resize(2);
  }

  double stable_step(double about) {
    if (!E_.empty()) system_.store_strain(E_.data());
    return mode_.stable_step(*this, about, !E_.empty());
  }

  void begin(double inverse_step) {
    inverse_step_ = inverse_step;
    system_.gather_acting(system_.present_view(), history(), base_.data());
  }
  void add_noise(double part) {
    const double each = part / std::sqrt(static_cast<double>(std::max(1, system_.free_count())));
    seed_ += static_cast<std::uint64_t>(dofs_);
    system_.for_nodes([&]<bool Frames>() {
      Space::for_each(nodes(), kernels::AddModeNoise<Frames>{view(0), seed_, each});
    });
  }
  double normalize(int k) {
    system_.for_nodes([&]<bool Frames>() {
      Space::template sum<1, 1>(nodes(), kernels::SolveMass<Frames>{view(k)}, kernels::StoreSums<1, 1>{sums_.data()});
    });
    const std::vector<double> found = sums_.downloaded();
    largest_ = found[1];
    return found[0];
  }
  void scale(int k, double s) {
    Space::for_each(dofs_, kernels::ScaleMode{basis_[k].data(), v_.data(), s});
    largest_ *= s;
  }
  double product() {
    const double reach = kModeReach / std::max(largest_, 1e-300);
    system_.for_nodes([&]<bool Frames>() {
      Space::for_each(nodes(), kernels::MoveAlong<Frames>{view(0), reach, u_.data(), D_.data()});
    });
    system_.place_dependents(u_.data(), D_.data());
    kernels::ExplicitView moved = system_.present_view();
    moved.u = u_.data();
    moved.D = D_.data();
    system_.gather_acting(moved, history(), w_.data());
    system_.for_nodes([&]<bool Frames>() {
      Space::template sum<1>(nodes(), kernels::TakeDifference<Frames>{view(0), reach},
                             kernels::StoreSums<1, 0>{sums_.data()});
    });
    return sums_.downloaded()[0];
  }
  void advance(int k, double a, double b) {
    Space::for_each(dofs_, kernels::NextOfBasis{w_.data(), basis_[k].data(), basis_[k > 0 ? k - 1 : 0].data(), a, b,
                                                basis_[k + 1].data()});
  }
  void combine(const double* s, int count) {
    kernels::CombineBasis all{{}, {}, count};
    for (int k = 0; k < count; ++k) {
      all.y[k] = basis_[k].data();
      all.s[k] = s[k];
    }
    Space::for_each(dofs_, all);
  }

 private:
  int nodes() const { return system_.model().node_count(); }
  HistoryView history() const { return {E_.data(), E_.empty() ? 0.0 : inverse_step_}; }
  kernels::ModeView view(int k) {
    return {system_.present_view(), basis_[k].data(), v_.data(), w_.data(), base_.data()};
  }

  System& system_;
  int dofs_;
  FastestMode mode_;
  double inverse_step_ = 0, largest_ = 0;
  std::uint64_t seed_ = 0;
  Array<Space, double> base_, v_, w_, sums_, E_;
  Array<Space, double> basis_[kModeBasis];
  Array<Space, Vec3d> u_;
  Array<Space, Mat3d> D_;
};

}  // namespace fascia::gpu
