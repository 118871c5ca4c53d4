#pragma once

#include "core/base/index.hpp"
#include "core/space/space.hpp"
#include "gpu/blocks/point_kernels.hpp"

#include <algorithm>

/// The bodies of Points, for the files that instantiate it.
namespace fascia::gpu {

template <class Space>
Points<Space>::Points(const PointSet& set, Precision precision)
    : is_narrow_(precision != Precision::full), remembers_(!set.beside.empty()) {
  slot_begin_.upload(set.slot_begin);
  slot_node_.upload(set.slot_node);
  node_slot_begin_.upload(set.node_slot_begin);
  node_slot_.upload(set.node_slot);
  rule_.upload(set.rule);
  std::vector<int> slot_group(at(set.slot_count()));
  std::vector<char> blends(at(set.group_count()));
  std::vector<std::vector<int>> groups;
  for (int g = 0; g < set.group_count(); ++g) {
    std::fill(slot_group.begin() + set.slot_begin[at(g)], slot_group.begin() + set.slot_begin[at(g + 1)], g);
    const PointRule& rule = set.rule[at(g)].rule;
    blends[at(g)] = rule.stabilization != Stabilization::none;
    with_kind(rule, [&]<PointKind Kind>() {
      std::size_t k = 0;
      while (k < kinds_.size() &&
             (kinds_[k].kind.law != Kind.law || kinds_[k].kind.stabilization != Kind.stabilization))
        ++k;
      if (k == kinds_.size()) {
        kinds_.push_back({Kind, {}});
        groups.emplace_back();
      }
      groups[k].push_back(g);
    });
  }
  for (std::size_t k = 0; k < kinds_.size(); ++k) kinds_[k].groups.upload(groups[k]);
  slot_group_.upload(slot_group);
  blends_.upload(blends);
  targets_.resize(set.axes.size() / 3);
  targets_.set_zero();
  quantities_.resize(at(set.group_count()) * kGroupSize * kQuantities);
  upload<double>(set);
  if (is_narrow_) upload<float>(set);
}

template <class Space>
template <class T>
void Points<Space>::upload(const PointSet& set) {
  Rows<T>& r = rows<T>();
  const auto lanes = at(set.group_count()) * kGroupSize;
  r.shape.upload_rounded(std::span<const double>(set.shape));
  r.material.upload_rounded(std::span<const double>(set.material));
  r.axes.upload_rounded(std::span<const double>(set.axes));
  r.own.upload_rounded(std::span<const double>(set.own));
  r.stress.resize(lanes * 18);
  r.stress.set_zero();
  r.slot_sums.resize(at(set.slot_count()) * 12);
  if (is_narrow_ != std::is_same_v<T, double>) r.motion.resize(lanes * kPointRows);
  r.view = {set.group_count(),  set.slot_count(),        slot_begin_.data(), slot_node_.data(),
            slot_group_.data(), node_slot_begin_.data(), node_slot_.data(),  r.shape.data(),
            r.material.data(),  r.axes.data(),           r.own.data(),       rule_.data(),
            blends_.data(),     targets_.data(),         r.stress.data(),    r.slot_sums.data(),
            r.motion.data(),    quantities_.data()};
}

/// Calls act.operator()<Kind>(groups, count) for each kind.
template <class Space>
template <class Act>
void Points<Space>::for_kinds(const Act& act) {
  for (Kind& k : kinds_)
    with_kind({k.kind.law, k.kind.stabilization, false}, [&]<PointKind K>() {
      act.template operator()<K>(k.groups.data(), static_cast<int>(k.groups.size()) * kGroupSize);
    });
}

namespace kernels {

/// v P g and v (P Bᵀ + w Y) of a point on a slot of its group.
template <class T>
struct SlotTerm {
  PointsOf<T> set;
  FASCIA_HD void operator()(int slot, int lane, Sums<12>& sums) const {
    const int group = set.slot_group[slot];
    const T *stress = set.stress + static_cast<std::size_t>(group) * 18 * kGroupSize, *shape = shape_of(set, slot);
    const Mat3<T> P = matrix(stress, 0, lane);
    const Vec3<T> force = P * Vec3<T>{{row(shape, 1, lane), row(shape, 2, lane), row(shape, 3, lane)}};
    Mat3<T> N = times_transpose(P, matrix(shape, 4, lane));
    if (set.blends[group] != 0) N += matrix(stress, 9, lane) * row(shape, 0, lane);
    for (int i = 0; i < 3; ++i) {
      sums.v[i] += force[i];
      for (int j = 0; j < 3; ++j) sums.v[3 + 3 * i + j] += N(i, j);
    }
  }
};
template <class T>
struct StoreSlot {
  T* slot_sums;
  FASCIA_HD void operator()(int slot, const Sums<12>& sums) const {
    T* out = slot_sums + static_cast<std::size_t>(slot) * 12;
    for (int k = 0; k < 12; ++k) out[k] = static_cast<T>(sums.v[k]);
  }
};

template <PointKind Kind>
struct PointForces {
  PointsView set;
  NodesView nodes;
  PoseView pose;
  HistoryView history;
  const double* part_motion;
  const int* groups;

  FASCIA_HD void operator()(int i) const {
    constexpr bool kBlend = Kind.stabilization != Stabilization::none;
    const int group = groups[i / kGroupSize], lane = i % kGroupSize;
    const PointMotion<double> x = motion_of<kBlend>(set, group, lane, pose.u, pose.D);
    const auto m = material<Kind.law>(set, group, lane, history.inverse_step, history.given);
    const Mat3d E_old = old_strain(history, group, lane);
    PointStress<double> stress = point_stress<Kind.stabilization>(x, m, E_old);
    if (history.given != nullptr) stress.P += first_piola(x.H, given_stress(history.given, group, lane));
    const Mat3d P = stress.P * m.volume;
    store_stress(set, group, lane, P, stress.Y * m.volume);
    if (part_motion == nullptr) return;
    PointEnergy<double> energy = point_energy<Kind.stabilization>(x, m, E_old);
    if (history.given != nullptr) split_energy(group, lane, x, energy);
    const double motion = part_motion[nodes.part[set.slot_node[set.slot_begin[group]]]];
    const double g = row(set.material + static_cast<std::size_t>(group) * 6 * kGroupSize, kGradientNorm, lane);
    const double stiffness = m.volume * (m.lambda + m.mu * 2.0) * (1.0 + m.viscosity);
    const double strain = is_tether(m) ? 0.0 : contract(x.H, x.H), pull = contract(P, P), moved = g * motion;
    double* q = set.quantities + (static_cast<std::size_t>(group) * kGroupSize + lane) * kQuantities;
    q[kElastic] = energy.elastic;
    q[kStabilizing] = energy.stabilization;
    q[kViscous] = energy.viscous;
    q[kRounding] = g * g * (pull + stiffness * stiffness * (strain + moved * moved) * (1.0 + strain));
    q[kTether] = is_tether(m) ? pull : 0.0;
  }

 private:
  /// Where points remember stresses, what never fades is elastic, and the rest of the step's potential viscous.
  FASCIA_HD void split_energy(int group, int lane, const PointMotion<double>& x, PointEnergy<double>& energy) const {
    const auto lasting = material<Kind.law>(set, group, lane, history.inverse_step, history.given, kLastingFactors);
    const double elastic = point_energy<Kind.stabilization>(x, lasting, {}).elastic;
    const Mat3d given = given_stress(history.given, group, lane);
    energy.viscous += energy.elastic - elastic + lasting.volume * contract(given, green_strain(x.H));
    energy.elastic = elastic;
  }
};

/// Stores what fades of points: stabilisation does not.
template <PointKind Kind>
struct PointFading {
  PointsView set;
  PoseView pose;
  const double* given;
  double* out;
  const int* groups;

  FASCIA_HD void operator()(int i) const {
    const int group = groups[i / kGroupSize], lane = i % kGroupSize;
    const PointMotion<double> x = motion_of<false>(set, group, lane, pose.u, pose.D);
    const auto m = material<Kind.law>(set, group, lane, 0, given);
    Mat3d stress;
    if (!is_tether(m)) stress = tangent_stress<Stabilization::none>(x, m, Mat3d{}).S + given_stress(given, group, lane);
    store_symmetric(out + static_cast<std::size_t>(group) * 6 * kGroupSize, 0, lane, stress);
  }
};

template <PointKind Kind, class T>
struct PointLinearization {
  PointsView set;
  PoseView pose;
  HistoryView history;
  TakenStepView taken;
  const int* groups;
  T* motion;  ///< as PointsOf has it

  FASCIA_HD void operator()(int i) const {
    const int group = groups[i / kGroupSize], lane = i % kGroupSize;
    const PointMotion<double> x = motion_of<true>(set, group, lane, pose.u, pose.D);
    const auto m = material<Kind.law>(set, group, lane, history.inverse_step, history.given);
    const Mat3d E_old = old_strain(history, group, lane);
    TangentStress<double> stress;
    if (!is_tether(m)) stress = stress_of(x, m, group, lane, E_old);
    if (history.given != nullptr) stress.S += given_stress(history.given, group, lane);
    T* rows = motion + static_cast<std::size_t>(group) * kPointRows * kGroupSize;
    store_matrix(rows, 0, lane, x.H);
    store_matrix(rows, 9, lane, x.Dbar);
    store_symmetric(rows, 18, lane, stress.S);
    for (int k = 0; k < 3; ++k) rows[(24 + k) * kGroupSize + lane] = static_cast<T>(stress.drilling[k]);
    if (!taken.known()) return;
    const PointStress<double> p =
        is_tether(m) ? point_stress<Kind.stabilization>(x, m, E_old) : point_stress<Kind.stabilization>(x, m, stress);
    store_stress(set, group, lane, p.P * m.volume, p.Y * m.volume);
  }

 private:
  template <class Material>
  FASCIA_HD TangentStress<double> stress_of(const PointMotion<double>& x, const Material& m, int group, int lane,
                                            const Mat3d& E_old) const {
    if (!taken.known()) return tangent_stress<Kind.stabilization>(x, m, E_old);
    PointMotion<double> step = motion_of<true>(set, group, lane, taken.direction.dx, taken.direction.dA);
    step.H *= taken.length;
    step.Dbar *= taken.length;
    return extrapolated_stress<Kind.stabilization>(motion_of<true>(set, group, lane, taken.start.u, taken.start.D),
                                                   step, m, E_old);
  }
};

template <PointKind Kind, class T, class V>
struct PointProduct {
  PointsOf<T> set;
  DirectionOf<T, V> direction;
  double inverse_step;
  const double* given;
  Tangent tangent;
  const int* groups;

  FASCIA_HD void operator()(int i) const {
    constexpr bool kBlend = Kind.stabilization != Stabilization::none;
    const int group = groups[i / kGroupSize], lane = i % kGroupSize;
    const PointMotion<T> d = motion_of<kBlend>(set, group, lane, direction.dx, direction.dA);
    const auto m = material<Kind.law>(set, group, lane, inverse_step, given);
    const auto r = differential_of<Kind>(linearized_rows(set, group), lane, m, tangent, d);
    store_stress(set, group, lane, r.dP * m.volume, r.dY * m.volume);
  }
};

/// A column of a node's own block.
template <class T>
struct PointDiagonal {
  PointsOf<T> set;
  NodesView nodes;
  const Mat3d* Q;
  double inverse_step;
  const double* given;
  Tangent tangent;
  double* blocks;

  FASCIA_HD void operator()(int i) const {
    const int node = i / kMostDofs, k = i % kMostDofs, n = nodes.size(node);
    if (k >= n) return;
    double column[kMostDofs] = {};
    for (int s = set.node_slot_begin[node]; s < set.node_slot_begin[node + 1]; ++s)
      add_slot_column(set, set.node_slot[s], nodes.kind[node], Q[node], k, inverse_step, given, tangent, column);
    for (int r = 0; r < n; ++r) blocks[nodes.block[node] + static_cast<std::size_t>(n * r + k)] += column[r];
  }
};

}  // namespace kernels

template <class Space>
void Points<Space>::forces(const NodesView& nodes, const PoseView& pose, const HistoryView& history,
                           const double* part_motion) {
  HistoryView past = history;
  past.given = own_given(history.given);
  for_kinds([&]<PointKind K>(const int* groups, int lanes) {
    Space::for_each(lanes, kernels::PointForces<K>{view(), nodes, pose, past, part_motion, groups});
  });
  Space::template sum_lanes<12>(view().slots, kernels::SlotTerm<double>{view()},
                                kernels::StoreSlot<double>{view().slot_sums});
}

template <class Space>
void Points<Space>::linearize(const PoseView& pose, const HistoryView& history, Tangent tangent,
                              const TakenStepView& taken) {
  HistoryView past = history;
  past.given = given_ = own_given(history.given);
  inverse_step_ = history.inverse_step;
  tangent_ = tangent;
  is_narrow_ ? linearize_as<float>(pose, past, taken) : linearize_as<double>(pose, past, taken);
  if (!taken.known()) return;
  Space::template sum_lanes<12>(view().slots, kernels::SlotTerm<double>{view()},
                                kernels::StoreSlot<double>{view().slot_sums});
}

template <class Space>
template <class T>
void Points<Space>::linearize_as(const PoseView& pose, const HistoryView& history, const TakenStepView& taken) {
  T* motion = rows<T>().motion.data();
  for_kinds([&]<PointKind K>(const int* groups, int lanes) {
    Space::for_each(lanes, kernels::PointLinearization<K, T>{view(), pose, history, taken, groups, motion});
  });
}

template <class Space>
template <class T, class V>
void Points<Space>::product(const DirectionOf<T, V>& direction) {
  const PointsOf<T>& set = view_of<T>();
  for_kinds([&]<PointKind K>(const int* groups, int lanes) {
    Space::for_each(lanes, kernels::PointProduct<K, T, V>{set, direction, inverse_step_, given_, tangent_, groups});
  });
  Space::template sum_lanes<12>(set.slots, kernels::SlotTerm<T>{set}, kernels::StoreSlot<T>{set.slot_sums});
}

template <class Space>
void Points<Space>::add_diagonal(const NodesView& nodes, const Mat3d* Q, double* blocks) {
  is_narrow_ ? add_diagonal_as<float>(nodes, Q, blocks) : add_diagonal_as<double>(nodes, Q, blocks);
}

template <class Space>
template <class T>
void Points<Space>::add_diagonal_as(const NodesView& nodes, const Mat3d* Q, double* blocks) {
  Space::for_each(kMostDofs * nodes.count,
                  kernels::PointDiagonal<T>{view_of<T>(), nodes, Q, inverse_step_, given_, tangent_, blocks});
}

template <class Space>
std::vector<int> Points<Space>::item_parts(const PointSet& set) const {
  std::vector<int> parts;
  for (int g = 0; g < set.group_count(); ++g) parts.insert(parts.end(), kGroupSize, set.part_of_group(g));
  return parts;
}

template <class Space>
void Points<Space>::store_stress(const PoseView& pose, const double* given, double* out) {
  if (!remembers_) return;
  for_kinds([&]<PointKind K>(const int* groups, int lanes) {
    Space::for_each(lanes, kernels::PointFading<K>{view(), pose, given, out, groups});
  });
}

template <class Space>
void Points<Space>::store_strain(const PoseView& pose, double* E) {
  const PointsView set = view();
  Space::for_each(set.groups * kGroupSize, [set, pose, E] FASCIA_HD(int i) {
    const int group = i / kGroupSize, lane = i % kGroupSize;
    const PointMotion<double> x = kernels::motion_of<false>(set, group, lane, pose.u, pose.D);
    kernels::store_symmetric(E + static_cast<std::size_t>(group) * 6 * kGroupSize, 0, lane, green_strain(x.H));
  });
}

}  // namespace fascia::gpu
