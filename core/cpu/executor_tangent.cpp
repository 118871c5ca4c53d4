#include "core/cpu/executor.hpp"
#include "core/cpu/group_kernels.hpp"
#include "core/math/index.hpp"
#include "core/math/rotation.hpp"

#include <array>

namespace fascia {

using namespace kernels;

namespace {

PointMotion<Lanes> motion_of(const Linearization& lin, int group, int b) {
  const double* point = lin.points.data() + at(group) * 24 * kGroupSize;
  return {matrix(point, 0, b), matrix(point, 9, b)};
}

Mat3<Lanes> stress_of(const Linearization& lin, int group, int b) {
  return symmetric_matrix(lin.points.data() + at(group) * 24 * kGroupSize, 18, b);
}

Mat3d stored_matrix(const double* rows) {
  Mat3d m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = rows[3 * i + j];
  return m;
}

}  // namespace

template <bool Drilling>
void CpuExecutor::multiply_groups(const Linearization& lin, int begin, int end) {
  for (int group = begin; group < end; ++group) {
    const auto nodes = set_.nodes(group);
    const int first_slot = set_.slot_begin[at(group)];
    Mat3<Lanes> dP[kBatches], dY[kBatches];
    for (int b = 0; b < kBatches; ++b) {
      PointMotion<Lanes> direction;
      for (std::size_t s = 0; s < nodes.size(); ++s) {
        const double* d = directions_.data() + at(nodes[s]) * 12;
        add_slot<Drilling>(set_.shape_of_slot(first_slot + static_cast<int>(s)), b, broadcast(d),
                           broadcast(stored_matrix(d + 3)), direction);
      }
      const PointMaterial<Lanes> m = material(set_, group, b, lin.inverse_step);
      const auto r = point_stress_differential<Drilling>(motion_of(lin, group, b), stress_of(lin, group, b), m,
                                                         lin.tangent, direction.H, direction.Dbar);
      dP[b] = r.dP * m.volume;
      dY[b] = r.dY * m.volume;
    }
    for (std::size_t s = 0; s < nodes.size(); ++s) {
      const int slot = first_slot + static_cast<int>(s);
      slot_sums<Drilling>(set_.shape_of_slot(slot), dP, dY, slot_sums_.data() + at(slot) * 12);
    }
  }
}

void CpuExecutor::multiply(const Linearization& lin, std::span<const double> x, std::span<double> y) {
  pool_.for_ranges(set_.node_count, 256, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      double* d = directions_.data() + at(node) * 12;
      const double* xn = x.data() + at(node) * 6;
      const Mat3d W = skew(Vec3d{{xn[3], xn[4], xn[5]}}) * lin.Q[at(node)];
      for (int i = 0; i < 3; ++i) {
        d[i] = xn[i];
        for (int j = 0; j < 3; ++j) d[3 + 3 * i + j] = W(i, j);
      }
    }
  });
  pool_.for_ranges(set_.group_count(), 32, [&](int begin, int end) {
    if (drilling_)
      multiply_groups<true>(lin, begin, end);
    else
      multiply_groups<false>(lin, begin, end);
  });
  pool_.for_ranges(set_.node_count, 256, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      std::array<double, 12> sum{};
      for (int k = set_.node_slot_begin[at(node)]; k < set_.node_slot_begin[at(node + 1)]; ++k)
        for (int i = 0; i < 12; ++i) sum[at(i)] += slot_sums_[at(set_.node_slot[at(k)]) * 12 + at(i)];
      const Vec3d torque = axl(lin.Q[at(node)] * transpose(stored_matrix(sum.data() + 3)));
      const Block6& block = lin.node_blocks[at(node)];
      for (int i = 0; i < 6; ++i) {
        double value = i < 3 ? sum[at(i)] : torque[i - 3];
        for (int j = 0; j < 6; ++j) value += block[at(6 * i + j)] * x[at(6 * node + j)];
        y[at(6 * node + i)] = value;
      }
    }
  });
}

/// Column by column: the unit motion of one DOF of slot b gives dP and dY, and these the forces on slots a ≥ b.
template <bool Drilling>
void CpuExecutor::assemble_group(const Linearization& lin, int group, BlockMatrix& matrix_out) const {
  const auto nodes = set_.nodes(group);
  const int n = static_cast<int>(nodes.size()), first_slot = set_.slot_begin[at(group)];
  std::array<int, kMaxSlots> block_index;  // of (a, column slot)
  std::array<Mat3<Lanes>, kMaxSlots> A;    // Q B
  for (int batch = 0; batch < kBatches; ++batch) {
    const PointMaterial<Lanes> m = material(set_, group, batch, lin.inverse_step);
    const PointMotion<Lanes> x = motion_of(lin, group, batch);
    const Mat3<Lanes> S = stress_of(lin, group, batch);
    for (int a = 0; a < n; ++a)
      A[at(a)] = broadcast(lin.Q[at(nodes[at(a)])]) * kernels::matrix(set_.shape_of_slot(first_slot + a), 4, batch);
    for (int b = 0; b < n; ++b) {
      const double* shape_b = set_.shape_of_slot(first_slot + b);
      for (int a = b; a < n; ++a) block_index[at(a)] = matrix_out.find(nodes[at(a)], nodes[at(b)]);
      for (int k = 0; k < 6; ++k) {
        Mat3<Lanes> dH, dQbar;
        if (k < 3) {
          for (int j = 0; j < 3; ++j) dH(k, j) = row(shape_b, 1 + j, batch);
        } else {
          Vec3d e;
          e[k - 3] = 1;
          const Mat3<Lanes> rotation = broadcast(skew(e));
          dH = rotation * A[at(b)];
          if constexpr (Drilling) dQbar = (rotation * broadcast(lin.Q[at(nodes[at(b)])])) * row(shape_b, 0, batch);
        }
        const auto d = point_stress_differential<Drilling>(x, S, m, lin.tangent, dH, dQbar);
        const Mat3<Lanes> dP = d.dP * m.volume, dY = d.dY * m.volume;
        for (int a = b; a < n; ++a) {
          const double* shape_a = set_.shape_of_slot(first_slot + a);
          double* out = matrix_out.block(block_index[at(a)]) + k;
          Mat3<Lanes> Lt = times_transpose(A[at(a)], dP);
          if constexpr (Drilling)
            Lt += times_transpose(broadcast(lin.Q[at(nodes[at(a)])]), dY) * row(shape_a, 0, batch);
          const Vec3<Lanes> torque = axl(Lt);
          for (int i = 0; i < 3; ++i) {
            Lanes force;
            for (int j = 0; j < 3; ++j) force += dP(i, j) * row(shape_a, 1 + j, batch);
            out[6 * i] += lane_sum(force);
            out[6 * (3 + i)] += lane_sum(torque[i]);
          }
        }
      }
    }
  }
}

void CpuExecutor::assemble(const Linearization& lin, BlockMatrix& matrix_out) {
  matrix_out.set_zero();
  for (std::size_t c = 0; c + 1 < set_.color_begin.size(); ++c) {
    const int first = set_.color_begin[c];
    pool_.for_ranges(set_.color_begin[c + 1] - first, 8, [&](int begin, int end) {
      for (int i = first + begin; i < first + end; ++i) {
        if (drilling_)
          assemble_group<true>(lin, set_.color_group[at(i)], matrix_out);
        else
          assemble_group<false>(lin, set_.color_group[at(i)], matrix_out);
      }
    });
  }
  for (int node = 0; node < set_.node_count; ++node) {
    double* diagonal = matrix_out.block(matrix_out.diagonal(node));
    for (std::size_t k = 0; k < 36; ++k) diagonal[k] += lin.node_blocks[at(node)][k];
  }
  matrix_out.mirror_lower();
}

}  // namespace fascia
