#pragma once

#include "core/base/index.hpp"
#include "core/run/fastest_mode.hpp"
#include "core/space/array.hpp"
#include "core/step/mode_loops.hpp"
#include "core/step/step_loops.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace fascia {

/// The fastest mode of a state in the memory of a space: an Operator of FastestMode. Products with K are differences of
/// forces, so that each costs as much as a step.
/// @tparam System  steps a state by central differences. It has the types Space and Pose, and
///   space(), model(), free_count(), view(), for_nodes(act)
///   pose()                                 the present state
///   keep_strain()                          viscous stress is against that of the present state from here on, and
///                                          stresses that fade grow in full from there
///   gather_acting(pose, inverse_step, out) finds forces there, with the sign of a gradient and the viscous stress of
///                                          that 1/dt, without mass damping
///   place_dependents(pose)
template <class System>
class ExplicitMode {
 public:
  explicit ExplicitMode(System& system)
      : system_(system), space_(system.space()), dofs_(system.model().dof_count()), moved_(system.pose()) {
    // Nothing but displacements and D is used of the pose that moves.
    moved_.v = {};
    moved_.Q_dot = {};
    moved_.turned = {};
    moved_.memory = {};
    for (auto* vector : {&base_, &v_, &w_}) vector->resize(at(dofs_));
    for (auto& y : basis_) {
      y.resize(at(dofs_));
      y.set_zero();
    }
    sums_.resize(2);
  }

  /// @param about  what the stable step is about [s]
  double stable_step(double about) {
    system_.keep_strain();
    return mode_.stable_step(*this, about, system_.model().points.damped);
  }

  void begin(double inverse_step) {
    inverse_step_ = inverse_step;
    system_.gather_acting(system_.pose(), inverse_step_, base_.data());
  }
  void add_noise(double part) {
    const double each = part / std::sqrt(static_cast<double>(std::max(1, system_.free_count())));
    seed_ += static_cast<std::uint64_t>(dofs_);
    system_.for_nodes([&]<bool Frames>() {
      space_.for_each(nodes(), loops::AddModeNoise<Frames>{view(0), seed_, each});
    });
  }
  double normalize(int k) {
    system_.for_nodes([&]<bool Frames>() {
      space_.template sum<1, 1>(nodes(), loops::SolveMass<Frames>{view(k)}, loops::StoreSums<1, 1>{sums_.data()});
    });
    const std::vector<double> found = sums_.downloaded();
    largest_ = found[1];
    return found[0];
  }
  void scale(int k, double s) {
    space_.for_each(dofs_, loops::ScaleMode{basis_[k].data(), v_.data(), s});
    largest_ *= s;
  }
  double product() {
    const double reach = kModeReach / std::max(largest_, 1e-300);
    system_.for_nodes([&]<bool Frames>() {
      space_.for_each(nodes(), loops::MoveAlong<Frames>{view(0), reach, moved_.u.data(), moved_.D.data()});
    });
    system_.place_dependents(moved_);
    system_.gather_acting(moved_, inverse_step_, w_.data());
    system_.for_nodes([&]<bool Frames>() {
      space_.template sum<1>(nodes(), loops::TakeDifference<Frames>{view(0), reach},
                             loops::StoreSums<1, 0>{sums_.data()});
    });
    return sums_.downloaded()[0];
  }
  void advance(int k, double a, double b) {
    space_.for_each(dofs_, loops::NextOfBasis{w_.data(), basis_[k].data(), basis_[k > 0 ? k - 1 : 0].data(), a, b,
                                              basis_[k + 1].data()});
  }
  void combine(const double* s, int count) {
    loops::CombineBasis all{{}, {}, count};
    for (int k = 0; k < count; ++k) {
      all.y[k] = basis_[k].data();
      all.s[k] = s[k];
    }
    space_.for_each(dofs_, all);
  }

 private:
  using Space = typename System::Space;

  int nodes() const { return system_.model().node_count(); }
  loops::ModeView view(int k) { return {system_.view(), basis_[k].data(), v_.data(), w_.data(), base_.data()}; }

  System& system_;
  Space space_;
  int dofs_;
  FastestMode mode_;
  double inverse_step_ = 0, largest_ = 0;
  std::uint64_t seed_ = 0;
  typename System::Pose moved_;
  Array<Space, double> base_, v_, w_, sums_;
  Array<Space, double> basis_[kModeBasis];
};

}  // namespace fascia
