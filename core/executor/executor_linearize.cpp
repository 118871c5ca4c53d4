#include "core/base/index.hpp"
#include "core/executor/executor.hpp"
#include "core/executor/group_kernels.hpp"

#include <algorithm>

/// Linearization: all that products with the tangent need of a state.
namespace fascia {

using namespace kernels;

namespace {

/// I + D of each node.
void turn(const FrameMatrices& D, std::vector<Mat3d>& Q) {
  Q.resize(D.size());
  for (std::size_t i = 0; i < Q.size(); ++i) Q[i] = Mat3d::identity() + D[i];
}

}  // namespace

bool Linearization::symmetric() const {
  return followers.empty() && torques.empty() &&
         std::all_of(surfaces.begin(), surfaces.end(), [](const SurfaceTangent& s) { return s.load->has_potential; });
}

void CpuExecutor::linearize(const State& state, const StrainHistory& history, Tangent tangent, Linearization& out,
                            bool tethers_turn, const TakenStep* taken) {
  out.tangent = tangent;
  out.inverse_step = history.inverse_step;
  out.surfaces.clear();
  out.low_rank.clear();
  out.followers.clear();
  out.torques.clear();
  if (tangent == Tangent::material) taken = nullptr;
  out.extrapolated = taken != nullptr;
  linearize_points(state, history, taken, out);
  const std::vector<Mat3d>& turning = taken != nullptr && set_.group_count() > 0 ? extrapolated_L_ : node_L_;
  turn(state.D, out.Q);
  out.node_blocks.assign(set_.dofs.block_total(), 0.0);
  for (int node = 0; node < set_.node_count(); ++node) {
    if (tangent == Tangent::material || set_.dofs.kind(node) != FrameKind::rigid) continue;
    const Mat3d L = tethers_turn || tether_L_.empty() ? turning[at(node)] : turning[at(node)] - tether_L_[at(node)];
    const Mat3d rr = sym(L) - Mat3d::diagonal(trace(L));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out.node_blocks[set_.dofs.block_begin(node) + at(6 * (3 + i) + 3 + j)] = rr(i, j);
  }
  linearize_springs(state, out);
  out.u = state.u;
  if (elements_.empty() && shells_.empty()) return;
  out.E = history.E;
  if (!shells_.empty()) out.D.assign(state.D.values().begin(), state.D.values().end());
  if (taken != nullptr) extrapolate_blocks(history, *taken, out);
}

/// Points, and what their stresses do to turning frames where those are extrapolated.
void CpuExecutor::linearize_points(const State& state, const StrainHistory& history, const TakenStep* taken,
                                   Linearization& out) {
  out.points.resize(at(set_.group_count()) * Linearization::kRows * kGroupSize);
  if (set_.group_count() == 0) return;
  if (taken != nullptr) {
    turn(taken->D, out.Q);  // those of the state follow
    spread_direction(taken->d, out.Q);
  }
  pool_.for_ranges(set_.group_count(), 32, [&](int begin, int end) {
    for (int group = begin; group < end; ++group)
      with_kind(rule_of(group), [&]<PointKind Kind>() { linearize_group<Kind>(state, history, group, taken, out); });
  });
  if (taken == nullptr) return;
  extrapolated_L_.resize(at(set_.node_count()));
  pool_.for_ranges(set_.node_count(), 256, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      if (set_.dofs.kind(node) != FrameKind::rigid) continue;
      const Mat3d N = gradient_of_groups(0, set_.group_count(), node).N;
      extrapolated_L_[at(node)] = N + times_transpose(N, state.D[at(node)]);  // N Qᵀ
    }
  });
}

template <PointKind Kind>
void CpuExecutor::linearize_group(const State& state, const StrainHistory& history, int group, const TakenStep* taken,
                                  Linearization& out) {
  constexpr bool kBlend = Kind.stabilization != Stabilization::none;
  const auto nodes = set_.nodes(group);
  const int first_slot = set_.slot_begin[at(group)];
  double* rows = out.points.data() + at(group) * Linearization::kRows * kGroupSize;
  Mat3<Lanes> P[kBatches], Y[kBatches];
  for (int b = 0; b < kBatches; ++b) {
    PointMotion<Lanes> x, start, step;
    for (std::size_t s = 0; s < nodes.size(); ++s) {
      const double* shape = set_.shape_of_slot(first_slot + static_cast<int>(s));
      add_slot<true>(shape, b, broadcast(state.u[at(nodes[s])]), broadcast(state.D[at(nodes[s])]), x);
      if (taken == nullptr) continue;
      const double* d = directions_.data() + at(nodes[s]) * 12;
      add_slot<true>(shape, b, broadcast(taken->u[at(nodes[s])]), broadcast(taken->D[at(nodes[s])]), start);
      add_slot<true>(shape, b, broadcast(d), broadcast(stored_matrix(d + 3)), step);
    }
    const Mat3<Lanes> E_old =
        history.E.empty() ? Mat3<Lanes>{} : symmetric_matrix(history.E.data() + at(group) * 6 * kGroupSize, 0, b);
    const auto m = material<Kind>(set_, group, b, history.inverse_step, targets_);
    TangentStress<Lanes> stress;
    if (!is_tether(m))
      stress = taken == nullptr ? tangent_stress<Kind.stabilization>(x, m, E_old)
                                : extrapolated_stress<Kind.stabilization>(start, step, m, E_old);
    store_matrix(rows, 0, b, x.H);
    store_matrix(rows, 9, b, x.Dbar);
    store_symmetric(rows, 18, b, stress.S);
    for (int k = 0; k < 3; ++k) store(rows, 24 + k, b, stress.drilling[k]);
    if (taken == nullptr) continue;
    const PointStress<Lanes> p =
        is_tether(m) ? point_stress<Kind.stabilization>(x, m, E_old) : point_stress<Kind.stabilization>(x, m, stress);
    P[b] = p.P * m.volume;
    Y[b] = p.Y * m.volume;
  }
  for (std::size_t s = 0; taken != nullptr && s < nodes.size(); ++s) {
    const int slot = first_slot + static_cast<int>(s);
    slot_sums<kBlend>(set_.shape_of_slot(slot), P, Y, slot_sums_.data() + at(slot) * 12);
  }
}

void CpuExecutor::extrapolate_blocks(const StrainHistory& history, const TakenStep& taken, Linearization& out) {
  out.stress.resize(strain_begin_.back() - block_strains_begin());
  const auto part = [&](std::size_t block) {
    return std::span(out.stress)
        .subspan(strain_begin_[block] - block_strains_begin(), strain_begin_[block + 1] - strain_begin_[block]);
  };
  const std::span<const Vec3d> dx = translations(taken.d);
  for (std::size_t b = 0; b < elements_.size(); ++b)
    if (set_.blocks[b].extrapolates())
      elements_[b].extrapolate({taken.u, strain_of_block(history.E, b), history.inverse_step}, dx, part(b));
  for (std::size_t s = 0; s < shells_.size(); ++s) {
    const std::size_t b = elements_.size() + s;
    shells_[s].extrapolate({taken.u, taken.D.values(), strain_of_block(history.E, b), history.inverse_step}, taken.d,
                           part(b));
  }
}

std::span<const double> CpuExecutor::stress_of_block(const Linearization& lin, std::size_t block) const {
  const bool extrapolates = block >= elements_.size() || set_.blocks[block].extrapolates();
  if (!lin.extrapolated || !extrapolates) return {};
  return std::span(lin.stress)
      .subspan(strain_begin_[block] - block_strains_begin(), strain_begin_[block + 1] - strain_begin_[block]);
}

}  // namespace fascia
