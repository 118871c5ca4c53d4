#include "core/executor/group_kernels.hpp"
#include "core/executor/point_executor.hpp"
#include "core/linear/block_matrix.hpp"

#include <algorithm>
#include <array>

/// The tangent of points: what is kept of a state, products, entries.
namespace fascia {

using namespace kernels;

namespace {

const double* rows_of(const BlockState& state, int group) {
  return state.kept.data() + at(group) * PointExecutor::kRows * kGroupSize;
}

PointMotion<Lanes> motion_of(const BlockState& state, int group, int b) {
  return {matrix(rows_of(state, group), 0, b), matrix(rows_of(state, group), 9, b)};
}

TangentStress<Lanes> stress_of(const BlockState& state, int group, int b) {
  const double* rows = rows_of(state, group);
  return {symmetric_matrix(rows, 18, b), {{row(rows, 24, b), row(rows, 25, b), row(rows, 26, b)}}};
}

}  // namespace

template <PointKind Kind>
void PointExecutor::linearize_group(const BlockState& now, const BlockState* start, const BlockDirection* step,
                                    int group, std::span<double> kept) {
  constexpr bool kBlend = Kind.stabilization != Stabilization::none;
  const auto nodes = set_.nodes(group);
  const int first_slot = set_.slot_begin[at(group)];
  double* rows = kept.data() + at(group) * kRows * kGroupSize;
  Mat3<Lanes> P[kBatches], Y[kBatches];
  for (int b = 0; b < kBatches; ++b) {
    PointMotion<Lanes> x, x_start, x_step;
    for (std::size_t s = 0; s < nodes.size(); ++s) {
      const double* shape = set_.shape_of_slot(first_slot + static_cast<int>(s));
      add_slot<true>(shape, b, broadcast(now.u[at(nodes[s])]), broadcast(turn_of(now, nodes[s])), x);
      if (start == nullptr) continue;
      const double* d = step->motions.data() + at(nodes[s]) * 12;
      add_slot<true>(shape, b, broadcast(start->u[at(nodes[s])]), broadcast(turn_of(*start, nodes[s])), x_start);
      add_slot<true>(shape, b, broadcast(d), broadcast(stored_matrix(d + 3)), x_step);
    }
    const Mat3<Lanes> E_old = old_strain(now, group, b);
    const auto m = material<Kind>(set_, group, b, now, targets_);
    TangentStress<Lanes> stress;
    if (!is_tether(m))
      stress = start == nullptr ? tangent_stress<Kind.stabilization>(x, m, E_old)
                                : extrapolated_stress<Kind.stabilization>(x_start, x_step, m, E_old);
    if (!now.given.empty()) stress.S += given_stress(now, group, b);
    store_matrix(rows, 0, b, x.H);
    store_matrix(rows, 9, b, x.Dbar);
    store_symmetric(rows, 18, b, stress.S);
    for (int k = 0; k < 3; ++k) store(rows, 24 + k, b, stress.drilling[k]);
    if (start == nullptr) continue;
    const PointStress<Lanes> p =
        is_tether(m) ? point_stress<Kind.stabilization>(x, m, E_old) : point_stress<Kind.stabilization>(x, m, stress);
    P[b] = p.P * m.volume;
    Y[b] = p.Y * m.volume;
  }
  for (std::size_t s = 0; start != nullptr && s < nodes.size(); ++s) {
    const int slot = first_slot + static_cast<int>(s);
    slot_sums<kBlend>(set_.shape_of_slot(slot), P, Y, slot_sums_.data() + at(slot) * 12);
  }
}

void PointExecutor::linearize(const BlockState& now, const BlockState* start, const BlockDirection* step,
                              std::span<double> kept) {
  pool_.for_ranges(set_.group_count(), 32, [&](int begin, int end) {
    for (int group = begin; group < end; ++group)
      with_kind(rule_of(group), [&]<PointKind Kind>() { linearize_group<Kind>(now, start, step, group, kept); });
  });
}

template <PointKind Kind>
void PointExecutor::product_of_group(const BlockState& state, int group, const BlockDirection& direction) {
  constexpr bool kBlend = Kind.stabilization != Stabilization::none;
  const auto nodes = set_.nodes(group);
  const int first_slot = set_.slot_begin[at(group)];
  Mat3<Lanes> dP[kBatches], dY[kBatches];
  for (int b = 0; b < kBatches; ++b) {
    PointMotion<Lanes> motion;
    for (std::size_t s = 0; s < nodes.size(); ++s) {
      const double* d = direction.motions.data() + at(nodes[s]) * 12;
      add_slot<kBlend>(set_.shape_of_slot(first_slot + static_cast<int>(s)), b, broadcast(d),
                       broadcast(stored_matrix(d + 3)), motion);
    }
    const auto m = material<Kind>(set_, group, b, state, targets_);
    const auto r = point_stress_differential<Kind.stabilization>(motion_of(state, group, b), stress_of(state, group, b),
                                                                 m, state.tangent, motion);
    dP[b] = r.dP * m.volume;
    dY[b] = r.dY * m.volume;
  }
  for (std::size_t s = 0; s < nodes.size(); ++s) {
    const int slot = first_slot + static_cast<int>(s);
    slot_sums<kBlend>(set_.shape_of_slot(slot), dP, dY, slot_sums_.data() + at(slot) * 12);
  }
}

void PointExecutor::compute_product(const BlockState& state, const BlockDirection& direction) {
  pool_.for_ranges(set_.group_count(), 32, [&](int begin, int end) {
    for (int group = begin; group < end; ++group)
      with_kind(rule_of(group), [&]<PointKind Kind>() { product_of_group<Kind>(state, group, direction); });
  });
}

namespace {

/// The motion of a point for a unit of one degree of freedom of a frame.
/// @param Q  I + D of the frame, A its product with B
template <bool Blend>
PointMotion<Lanes> unit_motion(FrameKind kind, int dof, const double* shape, int batch, const Mat3d& Q,
                               const Mat3<Lanes>& A) {
  PointMotion<Lanes> d;
  if (dof < 3) {
    for (int j = 0; j < 3; ++j) d.H(dof, j) = row(shape, 1 + j, batch);
  } else if (kind == FrameKind::rigid) {
    Vec3d e;
    e[dof - 3] = 1;
    const Mat3d rotation = skew(e);
    d.H = broadcast(rotation) * A;
    if constexpr (Blend) d.Dbar = broadcast(rotation * Q) * row(shape, 0, batch);
  } else {
    const int q = (dof - 3) / 3, i = (dof - 3) % 3;
    for (int j = 0; j < 3; ++j) d.H(i, j) = row(shape, 4 + 3 * q + j, batch);
    if constexpr (Blend) d.Dbar(i, q) = row(shape, 0, batch);
  }
  return d;
}

/// Adds what dP and dY are on a frame to one column of a block, whose rows are `stride` apart.
template <bool Blend>
void add_column(FrameKind kind, const double* shape, int batch, const Mat3d& Q, const Mat3<Lanes>& A,
                const Mat3<Lanes>& dP, const Mat3<Lanes>& dY, double* out, int stride) {
  for (int i = 0; i < 3; ++i) {
    Lanes force;
    for (int j = 0; j < 3; ++j) force += dP(i, j) * row(shape, 1 + j, batch);
    out[stride * i] += lane_sum(force);
  }
  if (kind == FrameKind::rigid) {
    Mat3<Lanes> Lt = times_transpose(A, dP);
    if constexpr (Blend) Lt += times_transpose(broadcast(Q), dY) * row(shape, 0, batch);
    const Vec3<Lanes> torque = axl(Lt);
    for (int i = 0; i < 3; ++i) out[stride * (3 + i)] += lane_sum(torque[i]);
    return;
  }
  if (kind == FrameKind::vertex) return;
  for (int q = 0; q < 3; ++q) {
    for (int i = 0; i < 3; ++i) {
      Lanes sum;
      for (int j = 0; j < 3; ++j) sum += dP(i, j) * row(shape, 4 + 3 * q + j, batch);
      if constexpr (Blend) sum += row(shape, 0, batch) * dY(i, q);
      out[stride * (3 + 3 * q + i)] += lane_sum(sum);
    }
  }
}

}  // namespace

/// Column by column: the unit motion of one degree of freedom of slot b gives dP and dY, and these the forces on slots
/// a ≥ b.
template <PointKind Kind>
void PointExecutor::assemble_group(const BlockState& state, int group, Entries entries, BlockMatrix& matrix_out) const {
  constexpr bool kBlend = Kind.stabilization != Stabilization::none;
  const auto nodes = set_.nodes(group);
  const int n = static_cast<int>(nodes.size()), first_slot = set_.slot_begin[at(group)];
  const bool upper = matrix_out.fills_upper();
  std::array<double*, kMaxSlots> block;  // of (a, column slot)
  std::array<Mat3<Lanes>, kMaxSlots> A;  // Q B
  std::array<Mat3d, kMaxSlots> Q;
  for (int a = 0; a < n; ++a) Q[at(a)] = Mat3d::identity() + turn_of(state, nodes[at(a)]);
  for (int batch = 0; batch < kBatches; ++batch) {
    const auto m = material<Kind>(set_, group, batch, state, targets_);
    const PointMotion<Lanes> x = motion_of(state, group, batch);
    const TangentStress<Lanes> stress = stress_of(state, group, batch);
    for (int a = 0; a < n; ++a)
      A[at(a)] = broadcast(Q[at(a)]) * kernels::matrix(set_.shape_of_slot(first_slot + a), 4, batch);
    for (int b = 0; b < n; ++b) {
      const int column_node = nodes[at(b)], columns = set_.dofs.size(column_node);
      const int end = entries == Entries::all ? n : b + 1;
      for (int a = b; a < end; ++a)
        block[at(a)] = matrix_out.block(upper ? matrix_out.find(column_node, nodes[at(a)])
                                              : matrix_out.find(nodes[at(a)], column_node));
      for (int k = 0; k < columns; ++k) {
        const PointMotion<Lanes> unit = unit_motion<kBlend>(
            set_.dofs.kind(column_node), k, set_.shape_of_slot(first_slot + b), batch, Q[at(b)], A[at(b)]);
        const auto d = point_stress_differential<Kind.stabilization>(x, stress, m, state.tangent, unit);
        const Mat3<Lanes> dP = d.dP * m.volume, dY = d.dY * m.volume;
        for (int a = b; a < end; ++a)
          add_column<kBlend>(set_.dofs.kind(nodes[at(a)]), set_.shape_of_slot(first_slot + a), batch, Q[at(a)],
                             A[at(a)], dP, dY, block[at(a)] + (upper ? k * set_.dofs.size(nodes[at(a)]) : k),
                             upper ? 1 : columns);
      }
    }
  }
}

void PointExecutor::assemble(const BlockState& state, BlockMatrix& matrix_out, Entries entries) {
  for (std::size_t c = 0; c + 1 < set_.color_begin.size(); ++c) {
    const int first = set_.color_begin[c];
    pool_.for_ranges(set_.color_begin[c + 1] - first, 8, [&](int begin, int end) {
      for (int i = first + begin; i < first + end; ++i) {
        const int group = set_.color_group[at(i)];
        with_kind(rule_of(group), [&]<PointKind Kind>() { assemble_group<Kind>(state, group, entries, matrix_out); });
      }
    });
  }
}

}  // namespace fascia
