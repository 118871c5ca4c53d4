#include "core/executor/executor.hpp"

#include "core/base/index.hpp"
#include "core/executor/group_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fascia {

using namespace kernels;

namespace {

constexpr int kGroupGrain = 32, kNodeGrain = 256;

/// Sum of a frame's slots in ascending order: force (3) and Σ v (P Bᵀ + w Y) (9).
struct NodeSum {
  Vec3d force{};
  Mat3d N{};
};

template <class Take>
NodeSum gather(const PointSet& set, const AlignedVector<double>& slot_sums, int node, const Take& take) {
  NodeSum sum;
  for (int k = set.node_slot_begin[at(node)]; k < set.node_slot_begin[at(node + 1)]; ++k) {
    if (!take(set.node_slot[at(k)])) continue;
    const double* s = slot_sums.data() + at(set.node_slot[at(k)]) * 12;
    for (int i = 0; i < 3; ++i) {
      sum.force[i] += s[i];
      for (int j = 0; j < 3; ++j) sum.N(i, j) += s[3 + 3 * i + j];
    }
  }
  return sum;
}

Lanes squared(const Mat3<Lanes>& m) { return contract(m, m); }

}  // namespace

CpuExecutor::CpuExecutor(const PointSet& set, ThreadPool& pool)
    : set_(set),
      pool_(pool),
      slot_sums_(at(set.slot_count()) * 12),
      group_elastic_(at(set.group_count())),
      group_stabilization_(at(set.group_count())),
      group_viscous_(at(set.group_count())),
      group_rounding_(at(set.group_count())),
      group_tether_(at(set.group_count())),
      part_motion_(at(set.part_count())),
      start_motion_(at(set.part_count())),
      part_rounding_(at(set.part_count())),
      part_tether_(at(set.part_count())),
      targets_(set.axes.size() / 3),
      node_L_(at(set.node_count())),
      directions_(at(set.node_count()) * 12) {
  std::size_t strains = at(set.group_count()) * 6 * kGroupSize;
  for (const ElementBlock& block : set.blocks) {
    strain_begin_.push_back(strains);
    strains += elements_.emplace_back(block, set, pool).strain_size();
  }
  for (const ShellBlock& shell : set.shells) {
    strain_begin_.push_back(strains);
    strains += shells_.emplace_back(shell, set, pool).strain_size();
  }
  strain_begin_.push_back(strains);
  for (int group = 0; group < set.group_count(); ++group) {
    if (set.rule[at(group)].rule.law != Law::tether) continue;
    slot_is_tether_.resize(at(set.slot_count()));
    tether_L_.resize(at(set.node_count()));
    std::fill(slot_is_tether_.begin() + set.slot_begin[at(group)],
              slot_is_tether_.begin() + set.slot_begin[at(group + 1)], 1);
  }
}

/// The largest displacement or rotation (taken at the part's length) of each part, and at least `least`.
void CpuExecutor::note_motion(const State& state, std::span<const double> least, std::span<double> motion) const {
  std::copy(least.begin(), least.end(), motion.begin());
  for (int node = 0; node < set_.node_count(); ++node) {
    const int part = set_.node_part[at(node)];
    const bool turns = set_.dofs.kind(node) != FrameKind::vertex;
    const double turn = turns ? set_.part_length[at(part)] * norm(state.D[at(node)]) : 0.0;
    motion[at(part)] = std::max({motion[at(part)], norm(state.u[at(node)]), turn});
  }
}

void CpuExecutor::start_from(const State& state) {
  const std::vector<double> none(part_motion_.size(), 0.0);
  note_motion(state, none, start_motion_);
}

template <PointKind Kind>
void CpuExecutor::gradient_of_group(const State& state, const StrainHistory& history, int group, bool all) {
  constexpr bool kBlend = Kind.stabilization != Stabilization::none;
  const auto nodes = set_.nodes(group);
  const int first_slot = set_.slot_begin[at(group)];
  Mat3<Lanes> P[kBatches], Y[kBatches];
  const Lanes motion(part_motion_[at(set_.part_of_group(group))]);
  double elastic = 0, stabilizing = 0, viscous = 0, rounding = 0, tether = 0;
  for (int b = 0; b < kBatches; ++b) {
    PointMotion<Lanes> x;
    for (std::size_t s = 0; s < nodes.size(); ++s)
      add_slot<kBlend>(set_.shape_of_slot(first_slot + static_cast<int>(s)), b, broadcast(state.u[at(nodes[s])]),
                       broadcast(state.D[at(nodes[s])]), x);
    const auto m = material<Kind>(set_, group, b, history.inverse_step, targets_);
    const Mat3<Lanes> E_old =
        history.E.empty() ? Mat3<Lanes>{} : symmetric_matrix(history.E.data() + at(group) * 6 * kGroupSize, 0, b);
    const PointStress<Lanes> stress = point_stress<Kind.stabilization>(x, m, E_old);
    P[b] = stress.P * m.volume;
    Y[b] = stress.Y * m.volume;
    if (!all) continue;
    const PointEnergy<Lanes> energy = point_energy<Kind.stabilization>(x, m, E_old);
    elastic += lane_sum(energy.elastic);
    stabilizing += lane_sum(energy.stabilization);
    viscous += lane_sum(energy.viscous);
    if (is_tether(m)) tether += lane_sum(squared(P[b]));
    // Rounding of F − I grows with the displacements that cancel in it, and passes through the stiffness.
    const Lanes g = row(set_.material_of_group(group), kGradientNorm, b);
    const Lanes stiffness = m.volume * (m.lambda + m.mu * Lanes(2.0)) * (Lanes(1.0) + m.viscosity);
    const Lanes strain = is_tether(m) ? Lanes{} : squared(x.H);  // a tether's H is a displacement
    rounding += lane_sum((g * g) * (squared(P[b]) + stiffness * stiffness * (strain + (g * motion) * (g * motion)) *
                                                        (Lanes(1.0) + strain)));
  }
  if (all) {
    group_elastic_[at(group)] = elastic;
    group_stabilization_[at(group)] = stabilizing;
    group_viscous_[at(group)] = viscous;
    group_rounding_[at(group)] = rounding;
    group_tether_[at(group)] = tether;
  }
  for (std::size_t s = 0; s < nodes.size(); ++s) {
    const int slot = first_slot + static_cast<int>(s);
    slot_sums<kBlend>(set_.shape_of_slot(slot), P, Y, slot_sums_.data() + at(slot) * 12);
  }
}

std::span<const double> CpuExecutor::strain_of_block(const AlignedVector<double>& E, std::size_t block) const {
  if (E.empty()) return {};
  return std::span(E).subspan(strain_begin_[block], strain_begin_[block + 1] - strain_begin_[block]);
}

/// Force of each node, with what linearize() needs of it.
void CpuExecutor::sum_forces(const State& state, bool keep_moments, std::span<double> gradient) {
  pool_.for_ranges(set_.node_count(), kNodeGrain, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      double* g = gradient.data() + set_.dofs.begin(node);
      Vec3d force;
      for (const ElementExecutor& block : elements_) force += block.sum_at(node);
      if (set_.group_count() == 0 && shells_.empty() && set_.dofs.kind(node) == FrameKind::vertex) {
        for (int k = 0; k < 3; ++k) g[k] = force[k];
        std::fill(g + 3, g + set_.dofs.size(node), 0.0);
        continue;
      }
      Vec3d torque;
      for (const ShellExecutor& shell : shells_) {
        const ShellExecutor::Force f = shell.sum_at(node);
        force += f.force;
        torque += f.torque;
      }
      const NodeSum sum = gather(set_, slot_sums_, node, [](int) { return true; });
      if (keep_moments) node_L_[at(node)] = sum.N + times_transpose(sum.N, state.D[at(node)]);  // N Qᵀ
      if (keep_moments && !tether_L_.empty()) {
        const Mat3d N = gather(set_, slot_sums_, node, [&](int slot) { return slot_is_tether_[at(slot)] != 0; }).N;
        tether_L_[at(node)] = N + times_transpose(N, state.D[at(node)]);
      }
      force += sum.force;
      for (int k = 0; k < 3; ++k) g[k] = force[k];
      std::fill(g + 3, g + set_.dofs.size(node), 0.0);
      add_moment(set_.dofs.kind(node), sum.N, Mat3d::identity() + state.D[at(node)], g + 3);
      if (set_.dofs.kind(node) == FrameKind::rigid)
        for (int k = 0; k < 3; ++k) g[3 + k] += torque[k];
    }
  });
}

void CpuExecutor::sum_terms(const State& state, const StrainHistory& history, bool all, std::span<double> gradient) {
  pool_.for_ranges(set_.group_count(), kGroupGrain, [&](int begin, int end) {
    for (int group = begin; group < end; ++group)
      with_kind(rule_of(group), [&]<PointKind Kind>() { gradient_of_group<Kind>(state, history, group, all); });
  });
  for (std::size_t b = 0; b < elements_.size(); ++b)
    elements_[b].compute_forces({state.u, strain_of_block(history.E, b), history.inverse_step}, all, part_motion_);
  for (std::size_t b = 0; b < shells_.size(); ++b)
    shells_[b].compute_forces(
        {state.u, state.D.values(), strain_of_block(history.E, elements_.size() + b), history.inverse_step}, all,
        part_motion_);
  sum_forces(state, all, gradient);
  add_spring_forces(state, gradient);
}

void CpuExecutor::forces(const State& state, const StrainHistory& history, std::span<double> gradient) {
  sum_terms(state, history, false, gradient);
}

InternalEnergy CpuExecutor::gradient(const State& state, const StrainHistory& history, std::span<double> gradient) {
  note_motion(state, start_motion_, part_motion_);
  sum_terms(state, history, true, gradient);
  InternalEnergy energy;
  std::fill(part_rounding_.begin(), part_rounding_.end(), 0.0);
  std::fill(part_tether_.begin(), part_tether_.end(), 0.0);
  for (int group = 0; group < set_.group_count(); ++group) {
    energy.elastic += group_elastic_[at(group)];
    energy.stabilization += group_stabilization_[at(group)];
    energy.viscous += group_viscous_[at(group)];
    part_tether_[at(set_.part_of_group(group))] += group_tether_[at(group)];
    part_rounding_[at(set_.part_of_group(group))] += group_rounding_[at(group)];
  }
  for (const ElementExecutor& block : elements_) {
    energy.elastic += block.elastic();
    energy.viscous += block.viscous();
    block.add_rounding(part_rounding_);
  }
  for (const ShellExecutor& shell : shells_) {
    energy.elastic += shell.elastic();
    energy.viscous += shell.viscous();
    shell.add_rounding(part_rounding_);
  }
  energy.elastic += note_springs(state);
  for (double& r : part_rounding_) r = std::numeric_limits<double>::epsilon() * std::sqrt(r);
  return energy;
}

CpuExecutor::NodeGradient CpuExecutor::gradient_of_groups(int first, int count, int node) const {
  const int begin = set_.slot_begin[at(first)], end = set_.slot_begin[at(first + count)];
  const NodeSum sum = gather(set_, slot_sums_, node, [&](int slot) { return slot >= begin && slot < end; });
  return {sum.force, sum.N};
}

Vec3d CpuExecutor::tether_stretch(const Tether& tether, const State& state) const {
  const auto nodes = set_.nodes(tether.group);
  Vec3d u;
  for (std::size_t s = 0; s < nodes.size(); ++s) {
    const double* shape = set_.shape_of_slot(set_.slot_begin[at(tether.group)] + static_cast<int>(s)) + tether.lane;
    const Vec3d lever{{shape[4 * kGroupSize], shape[7 * kGroupSize], shape[10 * kGroupSize]}};
    u += state.u[at(nodes[s])] * shape[kGroupSize] + state.D[at(nodes[s])] * lever;
  }
  const std::size_t first = at(set_.rule[at(tether.group)].axes) * 3 * kGroupSize + at(tether.lane);
  return Vec3d{{targets_[first], targets_[first + kGroupSize], targets_[first + 2 * kGroupSize]}} - u;
}

Vec3d CpuExecutor::tether_force(const Tether& tether, const State& state) const {
  const Vec3d stretch = tether_stretch(tether, state);
  const auto index = at(set_.rule[at(tether.group)].axes);
  Vec3d force;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      force[i] += set_.axes[(index * 9 + at(3 * i + j)) * kGroupSize + at(tether.lane)] * stretch[j];
  return force * set_.material_of_group(tether.group)[kVolume * kGroupSize + tether.lane];
}

void CpuExecutor::store_strain(const State& state, StrainHistory& history) {
  history.E.resize(strain_begin_.back());
  pool_.for_ranges(set_.group_count(), kGroupGrain, [&](int begin, int end) {
    for (int group = begin; group < end; ++group) {
      const auto nodes = set_.nodes(group);
      for (int b = 0; b < kBatches; ++b) {
        PointMotion<Lanes> x;
        for (std::size_t s = 0; s < nodes.size(); ++s)
          add_slot<false>(set_.shape_of_slot(set_.slot_begin[at(group)] + static_cast<int>(s)), b,
                          broadcast(state.u[at(nodes[s])]), broadcast(state.D[at(nodes[s])]), x);
        store_symmetric(history.E.data() + at(group) * 6 * kGroupSize, 0, b, green_strain(x.H));
      }
    }
  });
  for (std::size_t b = 0; b < elements_.size(); ++b)
    elements_[b].store_strain(state.u, std::span(history.E).subspan(strain_begin_[b], elements_[b].strain_size()));
  for (std::size_t b = 0; b < shells_.size(); ++b)
    shells_[b].store_strain(
        {state.u, state.D.values(), {}},
        std::span(history.E).subspan(strain_begin_[elements_.size() + b], shells_[b].strain_size()));
}

}  // namespace fascia
