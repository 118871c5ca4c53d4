#include "core/base/index.hpp"
#include "core/executor/executor.hpp"
#include "core/executor/group_kernels.hpp"
#include "core/math/rotation.hpp"

#include <algorithm>
#include <array>

namespace fascia {

using namespace kernels;

namespace {

const double* rows_of(const Linearization& lin, int group) {
  return lin.points.data() + at(group) * Linearization::kRows * kGroupSize;
}

PointMotion<Lanes> motion_of(const Linearization& lin, int group, int b) {
  return {matrix(rows_of(lin, group), 0, b), matrix(rows_of(lin, group), 9, b)};
}

TangentStress<Lanes> stress_of(const Linearization& lin, int group, int b) {
  const double* rows = rows_of(lin, group);
  return {symmetric_matrix(rows, 18, b), {{row(rows, 24, b), row(rows, 25, b), row(rows, 26, b)}}};
}

}  // namespace

template <PointKind Kind>
void CpuExecutor::multiply_group(const Linearization& lin, int group) {
  constexpr bool kBlend = Kind.stabilization != Stabilization::none;
  const auto nodes = set_.nodes(group);
  const int first_slot = set_.slot_begin[at(group)];
  Mat3<Lanes> dP[kBatches], dY[kBatches];
  for (int b = 0; b < kBatches; ++b) {
    PointMotion<Lanes> direction;
    for (std::size_t s = 0; s < nodes.size(); ++s) {
      const double* d = directions_.data() + at(nodes[s]) * 12;
      add_slot<kBlend>(set_.shape_of_slot(first_slot + static_cast<int>(s)), b, broadcast(d),
                       broadcast(stored_matrix(d + 3)), direction);
    }
    const auto m = material<Kind>(set_, group, b, lin.inverse_step, targets_);
    const auto r = point_stress_differential<Kind.stabilization>(motion_of(lin, group, b), stress_of(lin, group, b), m,
                                                                 lin.tangent, direction);
    dP[b] = r.dP * m.volume;
    dY[b] = r.dY * m.volume;
  }
  for (std::size_t s = 0; s < nodes.size(); ++s) {
    const int slot = first_slot + static_cast<int>(s);
    slot_sums<kBlend>(set_.shape_of_slot(slot), dP, dY, slot_sums_.data() + at(slot) * 12);
  }
}

ElementExecutor::At CpuExecutor::element_at(const Linearization& lin, std::size_t block) const {
  return {lin.u, strain_of_block(lin.E, block), lin.inverse_step, lin.tangent, stress_of_block(lin, block)};
}

ShellExecutor::At CpuExecutor::shell_at(const Linearization& lin, std::size_t shell) const {
  const std::size_t block = elements_.size() + shell;
  return {lin.u, lin.D, strain_of_block(lin.E, block), lin.inverse_step, lin.tangent, stress_of_block(lin, block)};
}

/// Motions of the nodes for products of points: dx, and dA of frames that stand at Q.
void CpuExecutor::spread_direction(std::span<const double> x, const std::vector<Mat3d>& Q) {
  pool_.for_ranges(set_.node_count(), 256, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      double* d = directions_.data() + at(node) * 12;
      const double* xn = x.data() + set_.dofs.begin(node);
      const Mat3d W = frame_variation(set_.dofs.kind(node), xn + 3, Q[at(node)]);
      for (int i = 0; i < 3; ++i) {
        d[i] = xn[i];
        for (int j = 0; j < 3; ++j) d[3 + 3 * i + j] = W(i, j);
      }
    }
  });
}

std::span<const Vec3d> CpuExecutor::translations(std::span<const double> x) {
  element_direction_.resize(at(set_.node_count()));
  for (int node = 0; node < set_.node_count(); ++node)
    std::copy_n(x.data() + set_.dofs.begin(node), 3, element_direction_[at(node)].v);
  return element_direction_;
}

double CpuExecutor::largest_spin(std::span<const double> direction) {
  if (elements_.empty()) return 0;
  const std::span<const Vec3d> dx = translations(direction);
  double largest = 0;
  for (ElementExecutor& block : elements_) largest = std::max(largest, block.largest_spin(dx));
  return largest;
}

void CpuExecutor::multiply(const Linearization& lin, std::span<const double> x, std::span<double> y) {
  if (set_.group_count() > 0) spread_direction(x, lin.Q);
  pool_.for_ranges(set_.group_count(), 32, [&](int begin, int end) {
    for (int group = begin; group < end; ++group)
      with_kind(rule_of(group), [&]<PointKind Kind>() { multiply_group<Kind>(lin, group); });
  });
  if (!elements_.empty()) {
    const std::span<const Vec3d> dx = translations(x);
    for (std::size_t b = 0; b < elements_.size(); ++b) elements_[b].compute_product(element_at(lin, b), dx);
  }
  for (std::size_t b = 0; b < shells_.size(); ++b) shells_[b].compute_product(shell_at(lin, b), x);
  pool_.for_ranges(set_.node_count(), 256, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      std::array<double, 12> sum{};
      for (int k = set_.node_slot_begin[at(node)]; k < set_.node_slot_begin[at(node + 1)]; ++k)
        for (int i = 0; i < 12; ++i) sum[at(i)] += slot_sums_[at(set_.node_slot[at(k)]) * 12 + at(i)];
      for (const ElementExecutor& block : elements_) {
        const Vec3d force = block.sum_at(node);
        for (int i = 0; i < 3; ++i) sum[at(i)] += force[i];
      }
      Vec3d torque;
      for (const ShellExecutor& shell : shells_) {
        const ShellExecutor::Force f = shell.sum_at(node);
        for (int i = 0; i < 3; ++i) sum[at(i)] += f.force[i];
        torque += f.torque;
      }
      const int n = set_.dofs.size(node);
      const double* block = lin.node_blocks.data() + set_.dofs.block_begin(node);
      const double* xn = x.data() + set_.dofs.begin(node);
      double* yn = y.data() + set_.dofs.begin(node);
      for (int i = 0; i < n; ++i) {
        yn[i] = i < 3 ? sum[at(i)] : 0.0;
        for (int j = 0; j < n; ++j) yn[i] += block[n * i + j] * xn[j];
      }
      add_moment(set_.dofs.kind(node), stored_matrix(sum.data() + 3), lin.Q[at(node)], yn + 3);
      if (set_.dofs.kind(node) == FrameKind::rigid)
        for (int i = 0; i < 3; ++i) yn[3 + i] += torque[i];
    }
  });
  for (const SurfaceTangent& surface : lin.surfaces) add_product(surface, set_.dofs, lin.Q, x, y);
  for (const RankOne& term : lin.low_rank) add_product(term, x, y);
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
void CpuExecutor::assemble_group(const Linearization& lin, int group, Entries entries, BlockMatrix& matrix_out) const {
  constexpr bool kBlend = Kind.stabilization != Stabilization::none;
  const auto nodes = set_.nodes(group);
  const int n = static_cast<int>(nodes.size()), first_slot = set_.slot_begin[at(group)];
  const bool upper = matrix_out.fills_upper();
  std::array<double*, kMaxSlots> block;  // of (a, column slot)
  std::array<Mat3<Lanes>, kMaxSlots> A;  // Q B
  for (int batch = 0; batch < kBatches; ++batch) {
    const auto m = material<Kind>(set_, group, batch, lin.inverse_step, targets_);
    const PointMotion<Lanes> x = motion_of(lin, group, batch);
    const TangentStress<Lanes> stress = stress_of(lin, group, batch);
    for (int a = 0; a < n; ++a)
      A[at(a)] = broadcast(lin.Q[at(nodes[at(a)])]) * kernels::matrix(set_.shape_of_slot(first_slot + a), 4, batch);
    for (int b = 0; b < n; ++b) {
      const int column_node = nodes[at(b)], columns = set_.dofs.size(column_node);
      const int end = entries == Entries::all ? n : b + 1;
      for (int a = b; a < end; ++a)
        block[at(a)] = matrix_out.block(upper ? matrix_out.find(column_node, nodes[at(a)])
                                              : matrix_out.find(nodes[at(a)], column_node));
      for (int k = 0; k < columns; ++k) {
        const PointMotion<Lanes> unit =
            unit_motion<kBlend>(set_.dofs.kind(column_node), k, set_.shape_of_slot(first_slot + b), batch,
                                lin.Q[at(column_node)], A[at(b)]);
        const auto d = point_stress_differential<Kind.stabilization>(x, stress, m, lin.tangent, unit);
        const Mat3<Lanes> dP = d.dP * m.volume, dY = d.dY * m.volume;
        for (int a = b; a < end; ++a)
          add_column<kBlend>(set_.dofs.kind(nodes[at(a)]), set_.shape_of_slot(first_slot + a), batch,
                             lin.Q[at(nodes[at(a)])], A[at(a)], dP, dY,
                             block[at(a)] + (upper ? k * set_.dofs.size(nodes[at(a)]) : k), upper ? 1 : columns);
      }
    }
  }
}

void CpuExecutor::assemble(const Linearization& lin, BlockMatrix& matrix_out, Entries entries) {
  matrix_out.set_zero();
  for (std::size_t c = 0; c + 1 < set_.color_begin.size(); ++c) {
    const int first = set_.color_begin[c];
    pool_.for_ranges(set_.color_begin[c + 1] - first, 8, [&](int begin, int end) {
      for (int i = first + begin; i < first + end; ++i) {
        const int group = set_.color_group[at(i)];
        with_kind(rule_of(group), [&]<PointKind Kind>() { assemble_group<Kind>(lin, group, entries, matrix_out); });
      }
    });
  }
  for (std::size_t b = 0; b < elements_.size(); ++b) elements_[b].assemble(element_at(lin, b), matrix_out);
  for (std::size_t b = 0; b < shells_.size(); ++b) shells_[b].assemble(shell_at(lin, b), matrix_out);
  for (int node = 0; node < set_.node_count(); ++node) {
    double* diagonal = matrix_out.block(matrix_out.diagonal(node));
    const double* own = lin.node_blocks.data() + set_.dofs.block_begin(node);
    for (int k = 0; k < set_.dofs.size(node) * set_.dofs.size(node); ++k) diagonal[k] += own[k];
  }
  for (const SurfaceTangent& surface : lin.surfaces) add_blocks(surface, lin.Q, matrix_out);
  matrix_out.mirror_lower();
}

}  // namespace fascia
