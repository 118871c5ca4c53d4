#include "core/executor/element_kernels.hpp"
#include "core/linear/block_matrix.hpp"

#include <algorithm>

/// Node-averaged volumetric strain (after Bonet and Burton 1998, as an energy): a linear tetrahedron that cannot change
/// its volume cannot move either, but the tetrahedra around a node together can. θ_a = Σ V θ / Σ V over the elements of
/// node a, energy Σ k_a V_a θ_a²/2 with V_a = Σ V/4 and the law's volumetric modulus k; an element feels the mean of
/// k_a θ_a of its nodes as pressure.
namespace fascia {

using namespace kernels;

void ElementExecutor::prepare_average() {
  node_volume_.assign(at(set_.node_count()), 0.0);
  node_modulus_.assign(at(set_.node_count()), 0.0);
  node_pressure_ = node_theta_ = node_volume_;
  slot_theta_.resize(slot_u_.size());
  std::vector<VolumetricMean> means(node_volume_.size());
  int e = 0;
  block_.for_each_element([&](std::span<const int> element) {
    const double v = block_.volume_of(e / kElementLanes, 0)[e % kElementLanes];
    const double k = volumetric_modulus(block_.law, block_.constants_of(e));
    for (const int node : element) {
      node_volume_[at(node)] += v / 4;
      means[at(node)].add(k, v / 4);
    }
    ++e;
  });
  for (std::size_t i = 0; i < means.size(); ++i) node_modulus_[i] = means[i].value();
}

/// k times the mean about each node of theta(H, dH).
template <class Theta>
void ElementExecutor::average_of(const BlockState& state, std::span<const Vec3d> dx, std::vector<double>& out,
                                 const Theta& theta) {
  pool_.for_ranges(block_.patch_count(), 1, [&](int patch, int) {
    gather_patch(state.u, patch, slot_u_);
    if (!dx.empty()) gather_patch(dx, patch, slot_d_);
    const auto first = at(block_.patch_begin[at(patch)]);
    double* sums = slot_theta_.data() + first;
    std::fill_n(sums, block_.nodes_of_patch(patch).size(), 0.0);
    for (int batch = block_.patch_batch[at(patch)]; batch < block_.patch_batch[at(patch) + 1]; ++batch) {
      for (int half = 0; half < kBatches; ++half) {
        Vec3<Lanes> u[4], d[4];
        gather<4>(block_, batch, half, slot_u_.data() + first, u);
        if (!dx.empty()) gather<4>(block_, batch, half, slot_d_.data() + first, d);
        const double* g = block_.gradient_of(batch, 0);
        const Lanes value =
            theta(displacement_gradient<4>(block_, g, half, u), displacement_gradient<4>(block_, g, half, d)) *
            row(block_.volume_of(batch, 0), 0, half) * Lanes(0.25);
        const std::uint16_t* local = block_.local_of(batch) + half * kBatchWidth;
        for (int a = 0; a < 4; ++a)
          for (int lane = 0; lane < kBatchWidth; ++lane) sums[local[a * kElementLanes + lane]] += value.v[lane];
      }
    }
  });
  const double factor = bulk_factor(state);
  pool_.for_ranges(set_.node_count(), 256, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      double sum = 0;
      for (int k = block_.node_slot_begin[at(node)]; k < block_.node_slot_begin[at(node + 1)]; ++k)
        sum += slot_theta_[at(block_.node_slot[at(k)])];
      out[at(node)] = sum == 0 ? 0.0 : factor * node_modulus_[at(node)] * sum / node_volume_[at(node)];
    }
  });
}

void ElementExecutor::average(const BlockState& state) {
  with_element_kind(block_.law, block_.nodes, [&]<Law L, int N>() {
    if constexpr (N == 4 && L != Law::corotational)
      average_of(state, {}, node_pressure_,
                 [](const Mat3<Lanes>& H, const Mat3<Lanes>&) { return SolidLaw<L, Lanes>::volumetric_strain(H); });
  });
}

void ElementExecutor::average_direction(const BlockState& state, std::span<const Vec3d> dx) {
  average(state);
  with_element_kind(block_.law, block_.nodes, [&]<Law L, int N>() {
    if constexpr (N == 4 && L != Law::corotational)
      average_of(state, dx, node_theta_, [](const Mat3<Lanes>& H, const Mat3<Lanes>& dH) {
        return contract(SolidLaw<L, Lanes>::volumetric_gradient(H), dH);
      });
  });
}

double ElementExecutor::average_energy(const BlockState& state) const {
  double energy = 0;
  for (std::size_t i = 0; i < node_pressure_.size(); ++i)
    if (node_modulus_[i] != 0)
      energy += 0.5 * node_volume_[i] * node_pressure_[i] * node_pressure_[i] / node_modulus_[i];
  return energy / bulk_factor(state);
}

/// This part of what acts in a step never fades.
double ElementExecutor::lasting_part(const BlockState& state) {
  return state.given.empty() ? 1.0 : state.given[(kLastingFactors + 1) * kElementLanes] / bulk_factor(state);
}

/// Σ k_a V_a G_a G_aᵀ with G_a = ∂θ_a/∂x, which reaches all nodes of the elements around a.
void ElementExecutor::assemble_average(const BlockState& state, BlockMatrix& matrix) {
  std::vector<Vec3d> element_gradient(at(block_.count) * 4);  // V/4 ∂θ/∂x of each element
  with_element_kind(block_.law, block_.nodes, [&]<Law L, int N>() {
    if constexpr (N == 4 && L != Law::corotational) {
      for (int patch = 0; patch < block_.patch_count(); ++patch) {
        gather_patch(state.u, patch, slot_u_);
        for (int batch = block_.patch_batch[at(patch)]; batch < block_.patch_batch[at(patch) + 1]; ++batch) {
          for (int half = 0; half < kBatches; ++half) {
            Vec3<Lanes> u[4];
            gather<4>(block_, batch, half, slot_u_.data() + at(block_.patch_begin[at(patch)]), u);
            const double* g = block_.gradient_of(batch, 0);
            const Mat3<Lanes> slope =
                SolidLaw<L, Lanes>::volumetric_gradient(displacement_gradient<4>(block_, g, half, u)) *
                (row(block_.volume_of(batch, 0), 0, half) * Lanes(0.25));
            for (int a = 0; a < 4; ++a) {
              const Vec3<Lanes> part = slope * gradient(g, a, half);
              for (int lane = 0; lane < kBatchWidth; ++lane) {
                const int e = batch * kElementLanes + half * kBatchWidth + lane;
                if (e < block_.count)
                  element_gradient[at(4 * e + a)] = {{part[0].v[lane], part[1].v[lane], part[2].v[lane]}};
              }
            }
          }
        }
      }
    }
  });
  std::vector<std::vector<std::pair<int, Vec3d>>> around(at(set_.node_count()));  // of node a: node b, Σ V/4 ∂θ/∂x_b
  int e = 0;
  block_.for_each_element([&](std::span<const int> element) {
    for (const int a : element)
      for (int b = 0; b < 4; ++b) {
        auto& list = around[at(a)];
        const auto known =
            std::find_if(list.begin(), list.end(), [&](const auto& entry) { return entry.first == element[at(b)]; });
        if (known == list.end())
          list.emplace_back(element[at(b)], element_gradient[at(4 * e + b)]);
        else
          known->second += element_gradient[at(4 * e + b)];
      }
    ++e;
  });
  const double factor = bulk_factor(state);
  for (std::size_t a = 0; a < around.size(); ++a) {
    for (const auto& [i, gi] : around[a]) {
      for (const auto& [j, gj] : around[a]) {
        if (matrix.fills_upper() ? j < i : j > i) continue;
        double* block = matrix.block(matrix.find(i, j));
        const int stride = matrix.dofs().size(j);
        const Mat3d part = outer(gi, gj) * (factor * node_modulus_[a] / node_volume_[a]);
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c) block[stride * r + c] += part(r, c);
      }
    }
  }
}

}  // namespace fascia
