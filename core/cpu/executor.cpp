#include "core/cpu/executor.hpp"

#include "core/cpu/group_kernels.hpp"
#include "core/math/index.hpp"

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

NodeSum gather(const PointSet& set, const AlignedVector<double>& slot_sums, int node) {
  NodeSum sum;
  for (int k = set.node_slot_begin[at(node)]; k < set.node_slot_begin[at(node + 1)]; ++k) {
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
      group_drilling_(at(set.group_count())),
      group_viscous_(at(set.group_count())),
      group_rounding_(at(set.group_count())),
      part_motion_(at(set.part_count())),
      part_rounding_(at(set.part_count())),
      node_L_(at(set.node_count)),
      directions_(at(set.node_count) * 12) {
  for (int group = 0; group < set.group_count(); ++group)
    for (int lane = 0; lane < kGroupSize; ++lane)
      drilling_ = drilling_ || set.material_of_group(group)[kDrilling * kGroupSize + lane] > 0;
}

/// Displacements and rotations (taken at the part's length) of each part, kept as a running maximum: a state that came
/// back to rest still carries the rounding of where it was.
void CpuExecutor::note_motion(const State& state) {
  for (int node = 0; node < set_.node_count; ++node) {
    const int part = set_.node_part[at(node)];
    const double turn = set_.part_length[at(part)] * norm(state.D[at(node)]);
    part_motion_[at(part)] = std::max({part_motion_[at(part)], norm(state.u[at(node)]), turn});
  }
}

template <bool Drilling>
void CpuExecutor::gradient_of_groups(const State& state, const StrainHistory& history, int begin, int end) {
  for (int group = begin; group < end; ++group) {
    const auto nodes = set_.nodes(group);
    const int first_slot = set_.slot_begin[at(group)];
    Mat3<Lanes> P[kBatches], Y[kBatches];
    const Lanes motion(part_motion_[at(set_.part_of_group(group))]);
    double elastic = 0, drilling = 0, viscous = 0, rounding = 0;
    for (int b = 0; b < kBatches; ++b) {
      PointMotion<Lanes> x;
      for (std::size_t s = 0; s < nodes.size(); ++s)
        add_slot<Drilling>(set_.shape_of_slot(first_slot + static_cast<int>(s)), b, broadcast(state.u[at(nodes[s])]),
                           broadcast(state.D[at(nodes[s])]), x);
      const PointMaterial<Lanes> m = material(set_, group, b, history.inverse_step);
      const Mat3<Lanes> E_old =
          history.E.empty() ? Mat3<Lanes>{} : symmetric_matrix(history.E.data() + at(group) * 6 * kGroupSize, 0, b);
      const PointStress<Lanes> stress = point_stress<Drilling>(x, m, E_old);
      P[b] = stress.P * m.volume;
      Y[b] = stress.Y * m.volume;
      const PointEnergy<Lanes> energy = point_energy(x, m, E_old);
      elastic += lane_sum(energy.elastic);
      drilling += lane_sum(energy.drilling);
      viscous += lane_sum(energy.viscous);
      // Rounding of F − I grows with the displacements that cancel in it, and passes through the stiffness.
      const Lanes g = row(set_.material_of_group(group), kGradientNorm, b);
      const Lanes stiffness = m.volume * (m.lambda + m.mu * Lanes(2.0));
      const Lanes strain = squared(x.H) + (g * motion) * (g * motion);
      rounding += lane_sum((g * g) * (squared(P[b]) + stiffness * stiffness * strain * (Lanes(1.0) + squared(x.H))));
    }
    group_elastic_[at(group)] = elastic;
    group_drilling_[at(group)] = drilling;
    group_viscous_[at(group)] = viscous;
    group_rounding_[at(group)] = rounding;
    for (std::size_t s = 0; s < nodes.size(); ++s) {
      const int slot = first_slot + static_cast<int>(s);
      slot_sums<Drilling>(set_.shape_of_slot(slot), P, Y, slot_sums_.data() + at(slot) * 12);
    }
  }
}

InternalEnergy CpuExecutor::gradient(const State& state, const StrainHistory& history, std::span<double> gradient) {
  note_motion(state);
  pool_.for_ranges(set_.group_count(), kGroupGrain, [&](int begin, int end) {
    if (drilling_)
      gradient_of_groups<true>(state, history, begin, end);
    else
      gradient_of_groups<false>(state, history, begin, end);
  });
  pool_.for_ranges(set_.node_count, kNodeGrain, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      const NodeSum sum = gather(set_, slot_sums_, node);
      const Mat3d L = sum.N + times_transpose(sum.N, state.D[at(node)]);  // N Qᵀ
      node_L_[at(node)] = L;
      const Vec3d torque = axl(transpose(L));
      for (int k = 0; k < 3; ++k) {
        gradient[at(6 * node + k)] = sum.force[k];
        gradient[at(6 * node + 3 + k)] = torque[k];
      }
    }
  });
  InternalEnergy energy;
  std::fill(part_rounding_.begin(), part_rounding_.end(), 0.0);
  for (int group = 0; group < set_.group_count(); ++group) {
    energy.elastic += group_elastic_[at(group)];
    energy.drilling += group_drilling_[at(group)];
    energy.viscous += group_viscous_[at(group)];
    part_rounding_[at(set_.part_of_group(group))] += group_rounding_[at(group)];
  }
  for (double& r : part_rounding_) r = std::numeric_limits<double>::epsilon() * std::sqrt(r);
  return energy;
}

void CpuExecutor::store_strain(const State& state, StrainHistory& history) {
  history.E.resize(at(set_.group_count()) * 6 * kGroupSize);
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
}

void CpuExecutor::linearize(const State& state, const StrainHistory& history, Tangent tangent, Linearization& out) {
  out.tangent = tangent;
  out.inverse_step = history.inverse_step;
  out.Q.resize(at(set_.node_count));
  out.node_blocks.assign(at(set_.node_count), Block6{});
  out.points.resize(at(set_.group_count()) * 24 * kGroupSize);
  for (int node = 0; node < set_.node_count; ++node) {
    out.Q[at(node)] = Mat3d::identity() + state.D[at(node)];
    if (tangent == Tangent::material) continue;
    const Mat3d& L = node_L_[at(node)];
    const Mat3d rr = sym(L) - Mat3d::diagonal(trace(L));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out.node_blocks[at(node)][at(6 * (3 + i) + 3 + j)] = rr(i, j);
  }
  pool_.for_ranges(set_.group_count(), kGroupGrain, [&](int begin, int end) {
    for (int group = begin; group < end; ++group) {
      const auto nodes = set_.nodes(group);
      double* point = out.points.data() + at(group) * 24 * kGroupSize;
      for (int b = 0; b < kBatches; ++b) {
        PointMotion<Lanes> x;
        for (std::size_t s = 0; s < nodes.size(); ++s)
          add_slot<true>(set_.shape_of_slot(set_.slot_begin[at(group)] + static_cast<int>(s)), b,
                         broadcast(state.u[at(nodes[s])]), broadcast(state.D[at(nodes[s])]), x);
        const Mat3<Lanes> E_old =
            history.E.empty() ? Mat3<Lanes>{} : symmetric_matrix(history.E.data() + at(group) * 6 * kGroupSize, 0, b);
        const PointMaterial<Lanes> m = material(set_, group, b, history.inverse_step);
        store_matrix(point, 0, b, x.H);
        store_matrix(point, 9, b, x.Dbar);
        store_symmetric(point, 18, b, point_stress<false>(x, m, E_old).S);
      }
    }
  });
}

}  // namespace fascia
