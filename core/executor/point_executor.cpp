#include "core/executor/point_executor.hpp"

#include "core/executor/point_kernels.hpp"

#include <algorithm>

namespace fascia {

using namespace kernels;

namespace {

/// Colours that have fewer keep most threads waiting; nodes share work better, and prepare frames more often.
constexpr std::size_t kGroupsOfColor = 8;

Lanes squared(const Mat3<Lanes>& m) { return contract(m, m); }

}  // namespace

PointExecutor::PointExecutor(const PointSet& set, ThreadPool& pool)
    : set_(set),
      pool_(pool),
      frames_(set, pool),
      has_tethers_(std::any_of(set.rule.begin(), set.rule.end(),
                               [](const GroupRule& group) { return group.rule.law == Law::tether; })),
      group_elastic_(at(set.group_count())),
      group_stabilization_(at(set.group_count())),
      group_viscous_(at(set.group_count())),
      group_rounding_(at(set.group_count())),
      group_tether_(at(set.group_count())),
      part_tether_(at(set.part_count())),
      targets_(set.axes.size() / 3) {
  kept_begin_.assign(1, 0);
  for (int group = 0; group < set.group_count(); ++group)
    kept_begin_.push_back(kept_begin_.back() + at(kept_rows(rule_of(group).stabilization) * kGroupSize));
  const Coloring& colors = frames_.shared_colors();
  if (colors.item.empty() || colors.item.size() >= kGroupsOfColor * (colors.begin.size() - 1)) return;
  group_of_slot_.resize(at(set.slot_count()));
  for (int group = 0; group < set.group_count(); ++group)
    std::fill(group_of_slot_.begin() + set.slot_begin[at(group)],
              group_of_slot_.begin() + set.slot_begin[at(group + 1)], group);
}

/// Where points remember stresses, what never fades is elastic, and the rest of the step's potential viscous.
template <Stabilization Tie, Law L>
void PointExecutor::split_energy(const BlockState& state, int group, int batch, const PointMotion<Lanes>& x,
                                 PointEnergy<Lanes>& energy) const {
  const auto lasting = material<L>(set_, group, batch, state, targets_, kLastingFactors);
  const Lanes elastic = point_energy<Tie>(x, lasting, {}).elastic;
  const Mat3<Lanes> E = green_strain(x.H);
  energy.viscous += energy.elastic - elastic + lasting.volume * contract(given_stress(state, group, batch), E);
  energy.elastic = elastic;
}

template <Stabilization Tie>
[[gnu::flatten]] GroupStress PointExecutor::stress_on_group(const BlockState& state, int group, Rows rows,
                                                            bool energies, std::span<const double> part_motion) {
  constexpr bool kBlend = Tie != Stabilization::none;
  GroupStress out;
  const Lanes motion(energies ? part_motion[at(set_.part_of_group(group))] : 0.0);
  double elastic = 0, stabilizing = 0, viscous = 0, rounding = 0, tether = 0;
  for (int b = 0; b < kBatches; ++b) {
    const PointMotion<Lanes> x = frames_.motion<kBlend>(group, b, rows);
    with_point_law(rule_of(group).law, [&]<Law L>() {
      const auto m = material<L>(set_, group, b, state, targets_);
      const Mat3<Lanes> E_old = old_strain(state, group, b);
      PointStress<Lanes> stress = point_stress<Tie>(x, m, E_old);
      if (!state.given.empty()) stress.P += first_piola(x.H, given_stress(state, group, b));
      const Mat3<Lanes> P = stress.P * m.volume;
      out.P[b].set(P);
      if constexpr (kBlend) out.Y[b].set(stress.Y * m.volume);
      if (!energies) return;
      PointEnergy<Lanes> energy = point_energy<Tie>(x, m, E_old);
      if (!state.given.empty()) split_energy<Tie, L>(state, group, b, x, energy);
      elastic += lane_sum(energy.elastic);
      stabilizing += lane_sum(energy.stabilization);
      viscous += lane_sum(energy.viscous);
      if (is_tether(m)) tether += lane_sum(squared(P));
      // Rounding of F − I grows with the displacements that cancel in it, and passes through the stiffness.
      const Lanes g = row(set_.material_of_group(group), kGradientNorm, b);
      const Lanes stiffness = m.volume * (m.lambda + m.mu * Lanes(2.0)) * (Lanes(1.0) + m.viscosity);
      const Lanes strain = is_tether(m) ? Lanes{} : squared(x.H);  // a tether's H is a displacement
      rounding += lane_sum((g * g) * (squared(P) + stiffness * stiffness * (strain + (g * motion) * (g * motion)) *
                                                       (Lanes(1.0) + strain)));
    });
  }
  if (energies) {
    group_elastic_[at(group)] = elastic;
    group_stabilization_[at(group)] = stabilizing;
    group_viscous_[at(group)] = viscous;
    group_rounding_[at(group)] = rounding;
    group_tether_[at(group)] = tether;
  }
  return out;
}

void PointExecutor::compute_forces(const BlockState& state, bool energies, std::span<const double> part_motion) {
  if (empty()) return;
  frames_.for_each_group(std::array{frames_.rows_of(state, now_)}, true, [&](int group, const auto& rows) {
    with_stabilization(rule_of(group).stabilization, [&]<Stabilization Tie>() {
      frames_.put<Tie != Stabilization::none>(group,
                                              stress_on_group<Tie>(state, group, rows[0], energies, part_motion));
    });
  });
  if (!energies) return;
  std::fill(part_tether_.begin(), part_tether_.end(), 0.0);
  for (int group = 0; group < set_.group_count(); ++group)
    part_tether_[at(set_.part_of_group(group))] += group_tether_[at(group)];
}

InternalEnergy PointExecutor::energy() const {
  InternalEnergy energy;
  for (std::size_t group = 0; group < group_elastic_.size(); ++group)
    energy += {group_elastic_[group], group_stabilization_[group], group_viscous_[group]};
  return energy;
}

void PointExecutor::add_rounding(std::span<double> squares_of_parts) const {
  for (int group = 0; group < set_.group_count(); ++group)
    squares_of_parts[at(set_.part_of_group(group))] += group_rounding_[at(group)];
}

void PointExecutor::store_slot_sums(const BlockState& state, std::vector<double>& out) {
  out.resize(at(set_.slot_count()) * 12);
  if (empty()) return;
  frames_.for_each_group(std::array{frames_.rows_of(state, now_)}, false, [&](int group, const auto& rows) {
    with_stabilization(rule_of(group).stabilization, [&]<Stabilization Tie>() {
      const GroupStress stress = stress_on_group<Tie>(state, group, rows[0], false, {});
      for (int slot = set_.slot_begin[at(group)]; slot < set_.slot_begin[at(group + 1)]; ++slot)
        slot_sums<Tie != Stabilization::none>(set_.shape_of_slot(slot), stress.P, stress.Y, out.data() + at(slot) * 12);
    });
  });
}

NodeSum sum_of_groups(const PointSet& set, std::span<const double> slot_sums, const BodyBlocks::Run& groups, int node) {
  const int begin = set.slot_begin[at(groups.first)], end = set.slot_begin[at(groups.end())];
  NodeSum sum;
  for (int k = set.node_slot_begin[at(node)]; k < set.node_slot_begin[at(node + 1)]; ++k) {
    const int slot = set.node_slot[at(k)];
    if (slot >= begin && slot < end) add_numbers(slot_sums.data() + at(slot) * 12, sum);
  }
  return sum;
}

Vec3d tether_stretch(const PointSet& set, std::span<const double> targets, const Tether& tether, const State& state) {
  const auto nodes = set.nodes(tether.group);
  Vec3d u;
  for (std::size_t s = 0; s < nodes.size(); ++s) {
    const double* shape = set.shape_of_slot(set.slot_begin[at(tether.group)] + static_cast<int>(s)) + tether.lane;
    const Vec3d lever{{shape[4 * kGroupSize], shape[7 * kGroupSize], shape[10 * kGroupSize]}};
    u += state.u[at(nodes[s])] * shape[kGroupSize] + state.D[at(nodes[s])] * lever;
  }
  const std::size_t first = at(set.rule[at(tether.group)].axes) * 3 * kGroupSize + at(tether.lane);
  return Vec3d{{targets[first], targets[first + kGroupSize], targets[first + 2 * kGroupSize]}} - u;
}

Vec3d tether_force(const PointSet& set, std::span<const double> targets, const Tether& tether, const State& state) {
  const Vec3d stretch = tether_stretch(set, targets, tether, state);
  const auto index = at(set.rule[at(tether.group)].axes);
  Vec3d force;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      force[i] += set.axes[(index * 9 + at(3 * i + j)) * kGroupSize + at(tether.lane)] * stretch[j];
  return force * set.material_of_group(tether.group)[kVolume * kGroupSize + tether.lane];
}

void PointExecutor::stress_of_group(const BlockState& state, int group, Rows rows, std::span<double> S) const {
  for (int b = 0; b < kBatches; ++b) {
    const PointMotion<Lanes> x = frames_.motion<false>(group, b, rows);
    Mat3<Lanes> stress;
    with_point_law(rule_of(group).law, [&]<Law L>() {
      const auto m = material<L>(set_, group, b, state, targets_);
      if (!is_tether(m)) stress = tangent_stress<Stabilization::none>(x, m, {}).S + given_stress(state, group, b);
    });
    store_symmetric(S.data() + at(group) * 6 * kGroupSize, 0, b, stress);
  }
}

void PointExecutor::store_stress(const BlockState& state, std::span<double> S) {
  if (empty()) return;
  frames_.for_each_group(std::array{frames_.rows_of(state, now_)}, false,
                         [&](int group, const auto& rows) { stress_of_group(state, group, rows[0], S); });
}

void PointExecutor::store_strain(const BlockState& state, std::span<double> E) {
  if (empty()) return;
  frames_.for_each_group(std::array{frames_.rows_of(state, now_)}, false, [&](int group, const auto& rows) {
    for (int b = 0; b < kBatches; ++b)
      store_symmetric(E.data() + at(group) * 6 * kGroupSize, 0, b,
                      green_strain(frames_.motion<false>(group, b, rows[0]).H));
  });
}

}  // namespace fascia
