#include "core/executor/element_batch.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

using namespace kernels;

template <Law L, int N>
[[gnu::flatten]] void ElementExecutor::product_of_patch(const BlockState& state, int patch, std::span<const Vec3d> dx) {
  gather_patch(state.u, patch, slot_u_);
  gather_patch(dx, patch, slot_d_);
  const auto first = at(block_.patch_begin[at(patch)]);
  const auto nodes = block_.nodes_of_patch(patch);
  std::fill_n(slot_sum_.begin() + static_cast<std::ptrdiff_t>(first), nodes.size(), Vec3d{});
  for (int batch = block_.patch_batch[at(patch)]; batch < block_.patch_batch[at(patch) + 1]; ++batch) {
    for (int half = 0; half < kBatches; ++half) {
      Vec3<Lanes> u[kRoom<N>], d[kRoom<N>], f[kRoom<N>];
      gather<N>(block_, batch, half, slot_u_.data() + first, u);
      gather<N>(block_, batch, half, slot_d_.data() + first, d);
      const Lanes pressure = block_.averaged ? mean_pressure(block_, batch, half, nodes, node_pressure_) : Lanes(0);
      BatchTangent<L, N> tangent(block_, batch, half, u, state, pressure);
      Mat3<Lanes> dH[BatchPoints<N>::kPoints], dP[BatchPoints<N>::kPoints];
      for (int q = 0; q < tangent.points.count(); ++q)
        dH[q] = displacement_gradient<N>(block_, block_.gradient_of(batch, q), half, d);
      tangent.differential(dH, dP);
      if (block_.averaged) {
        const Lanes dp = mean_pressure(block_, batch, half, nodes, node_theta_);
        if constexpr (L != Law::corotational)
          dP[0] += SolidLaw<L, Lanes>::volumetric_gradient(tangent.points.H[0]) * dp;
      }
      for (int q = 0; q < tangent.points.count(); ++q) {
        const Mat3<Lanes> force = dP[q] * tangent.points.v(q);
        const double* g = block_.gradient_of(batch, q);
        for (int a = 0; a < nodes_of<N>(block_); ++a) f[a] += force * gradient(g, a, half);
      }
      scatter<N>(block_, batch, half, f, slot_sum_.data() + first);
    }
  }
}

/// Beside product_of_patch(), which gathered the patch.
template <int N>
void ElementExecutor::add_penalty_product(const BlockState& state, int patch) {
  const auto first = at(block_.patch_begin[at(patch)]);
  for (int batch = block_.patch_batch[at(patch)]; batch < block_.patch_batch[at(patch) + 1]; ++batch) {
    for (int half = 0; half < kBatches; ++half) {
      Vec3<Lanes> u[kRoom<N>], d[kRoom<N>], f[kRoom<N>];
      gather<N>(block_, batch, half, slot_u_.data() + first, u);
      gather<N>(block_, batch, half, slot_d_.data() + first, d);
      const PenaltyTangent<N> tangent(block_, batch, half, u, state.tangent == Tangent::full);
      Mat3<Lanes> dH[BatchPoints<N>::kPoints], dP[BatchPoints<N>::kPoints];
      for (int q = 0; q < tangent.points.count(); ++q)
        dH[q] = displacement_gradient<N>(block_, block_.gradient_of(batch, q), half, d);
      tangent.differential(dH, dP);
      for (int q = 0; q < tangent.points.count(); ++q) {
        const Mat3<Lanes> force = dP[q] * tangent.points.v(q);
        for (int a = 0; a < nodes_of<N>(block_); ++a) f[a] += force * gradient(block_.gradient_of(batch, q), a, half);
      }
      scatter<N>(block_, batch, half, f, slot_sum_.data() + first);
    }
  }
}

template <Law L, int N>
void ElementExecutor::extrapolate_patch(const BlockState& start, int patch, std::span<double> S) const {
  const auto first = at(block_.patch_begin[at(patch)]);
  for (int batch = block_.patch_batch[at(patch)]; batch < block_.patch_batch[at(patch) + 1]; ++batch) {
    for (int half = 0; half < kBatches; ++half) {
      Vec3<Lanes> u[kRoom<N>], d[kRoom<N>];
      gather<N>(block_, batch, half, slot_u_.data() + first, u);
      gather<N>(block_, batch, half, slot_d_.data() + first, d);
      const BatchTangent<L, N> tangent(block_, batch, half, u, start, Lanes(0));
      for (int q = 0; q < tangent.points.count(); ++q) {
        const Mat3<Lanes> dF = displacement_gradient<N>(block_, block_.gradient_of(batch, q), half, d);
        store_symmetric(S.data() + symmetric_row(block_, batch, q), 0, half,
                        tangent.point(q).extrapolated_stress(dF, tangent.m));
      }
    }
  }
}

void ElementExecutor::linearize(const BlockState&, const BlockState* start, const BlockDirection* step,
                                std::span<double> kept) {
  if (kept.empty()) return;
  slot_d_.resize(slot_u_.size());
  with_element_kind(block_.law, block_.nodes, [&]<Law L, int N>() {
    if constexpr (is_of_points(L))
      pool_.for_ranges(block_.patch_count(), 1, [&](int patch, int) {
        gather_patch(start->u, patch, slot_u_);
        gather_patch(step->dx, patch, slot_d_);
        extrapolate_patch<L, N>(*start, patch, kept);
      });
  });
}

template <int N>
double ElementExecutor::spin_of_patch(int patch) const {
  const auto first = at(block_.patch_begin[at(patch)]);
  double largest = 0;
  for (int batch = block_.patch_batch[at(patch)]; batch < block_.patch_batch[at(patch) + 1]; ++batch) {
    for (int half = 0; half < kBatches; ++half) {
      Vec3<Lanes> d[kRoom<N>];
      gather<N>(block_, batch, half, slot_d_.data() + first, d);
      for (int q = 0; q < points_of<N>(block_); ++q) {
        const Vec3<Lanes> twice = axl(displacement_gradient<N>(block_, block_.gradient_of(batch, q), half, d));
        const Lanes squared = squared_norm(twice) * Lanes(0.25);
        for (int lane = 0; lane < kBatchWidth; ++lane) largest = std::max(largest, squared.v[lane]);
      }
    }
  }
  return std::sqrt(largest);
}

double ElementExecutor::largest_spin(const BlockDirection& direction) {
  if (block_.law == Law::linear) return 0;
  slot_d_.resize(slot_u_.size());
  patch_spin_.resize(at(block_.patch_count()));
  pool_.for_ranges(block_.patch_count(), 1, [&](int patch, int) {
    gather_patch(direction.dx, patch, slot_d_);
    patch_spin_[at(patch)] = block_.nodes == 4 ? spin_of_patch<4>(patch) : spin_of_patch<0>(patch);
  });
  double largest = 0;
  for (const double spin : patch_spin_) largest = std::max(largest, spin);
  return largest;
}

void ElementExecutor::compute_product(const BlockState& state, const BlockDirection& direction) {
  slot_d_.resize(slot_u_.size());
  if (block_.averaged) average_direction(state, direction.dx);
  with_element_kind(block_.law, block_.nodes, [&]<Law L, int N>() {
    pool_.for_ranges(block_.patch_count(), 1, [&](int patch, int) {
      product_of_patch<L, N>(state, patch, direction.dx);
      if (block_.penalised) add_penalty_product<N>(state, patch);
    });
  });
}

}  // namespace fascia
