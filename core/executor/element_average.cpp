#include "core/base/incidence.hpp"
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

/// Finds the nodes that each mean reaches, ascending, and where each element has its corners among them.
void ElementExecutor::find_reach() {
  std::vector<int> node;
  block_.for_each_element(
      [&](std::span<const int> element) { node.insert(node.end(), element.begin(), element.end()); });
  const auto for_each_corner = [&](const auto& act) {
    for (std::size_t k = 0; k < node.size(); ++k) act(node[k], static_cast<int>(k));
  };
  list_by_node(set_.node_count(), for_each_corner, reach_.corner_begin, reach_.corner);
  reach_.begin.assign(1, 0);
  reach_.slot.resize(4 * node.size());
  std::vector<int> near;
  for (int a = 0; a < set_.node_count(); ++a) {
    near.clear();
    const std::span<const int> corners = reach_.corners(a);
    for (const int corner : corners) near.insert(near.end(), &node[at(corner / 4 * 4)], &node[at(corner / 4 * 4)] + 4);
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    for (const int corner : corners)
      for (int b = 0; b < 4; ++b)
        reach_.slot[at(4 * corner + b)] = static_cast<std::uint16_t>(
            std::lower_bound(near.begin(), near.end(), node[at(corner / 4 * 4 + b)]) - near.begin());
    reach_.node.insert(reach_.node.end(), near.begin(), near.end());
    reach_.begin.push_back(static_cast<int>(reach_.node.size()));
  }
  reach_.element_gradient.resize(node.size());
  reach_.gradient.resize(reach_.node.size());
}

/// Finds V/4 ∂θ/∂x of the elements of a patch.
template <Law L>
void ElementExecutor::average_gradients_of_patch(const BlockState& state, int patch) {
  gather_patch(state.u, patch, slot_u_);
  for (int batch = block_.patch_batch[at(patch)]; batch < block_.patch_batch[at(patch) + 1]; ++batch) {
    for (int half = 0; half < kBatches; ++half) {
      Vec3<Lanes> u[4];
      gather<4>(block_, batch, half, slot_u_.data() + at(block_.patch_begin[at(patch)]), u);
      const double* g = block_.gradient_of(batch, 0);
      const Mat3<Lanes> slope = SolidLaw<L, Lanes>::volumetric_gradient(displacement_gradient<4>(block_, g, half, u)) *
                                (row(block_.volume_of(batch, 0), 0, half) * Lanes(0.25));
      for (int a = 0; a < 4; ++a) {
        const Vec3<Lanes> part = slope * gradient(g, a, half);
        for (int lane = 0; lane < kBatchWidth; ++lane) {
          const int e = batch * kElementLanes + half * kBatchWidth + lane;
          if (e < block_.count)
            reach_.element_gradient[at(4 * e + a)] = {{part[0].v[lane], part[1].v[lane], part[2].v[lane]}};
        }
      }
    }
  }
}

/// Sums G_a of one node.
void ElementExecutor::sum_average_gradient(int a) {
  Vec3d* sum = reach_.gradient.data() + reach_.begin[at(a)];
  std::fill_n(sum, reach_.nodes(a).size(), Vec3d{});
  for (const int corner : reach_.corners(a))
    for (int b = 0; b < 4; ++b) sum[reach_.slot[at(4 * corner + b)]] += reach_.element_gradient[at(corner / 4 * 4 + b)];
}

/// Adds a row of blocks: what the means that reach its node have for it and the other nodes that they reach.
void ElementExecutor::assemble_average_row(int i, double factor, BlockMatrix& matrix) const {
  const std::span<const int> columns = matrix.columns(i);
  for (const int a : reach_.nodes(i)) {
    const std::span<const int> nodes = reach_.nodes(a);
    const Vec3d* G = reach_.gradient.data() + reach_.begin[at(a)];
    const double stiffness = factor * node_modulus_[at(a)] / node_volume_[at(a)];
    const auto own = static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), i) - nodes.begin());
    const std::size_t first = matrix.fills_upper() ? own : 0, end = matrix.fills_upper() ? nodes.size() : own + 1;
    std::size_t column = 0;
    for (std::size_t b = first; b < end; ++b) {
      while (columns[column] < nodes[b]) ++column;
      double* block = matrix.block(matrix.row_begin(i) + static_cast<int>(column));
      const int stride = matrix.dofs().size(nodes[b]);
      const Mat3d part = outer(G[own], G[b]) * stiffness;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) block[stride * r + c] += part(r, c);
    }
  }
}

/// Σ k_a V_a G_a G_aᵀ with G_a = ∂θ_a/∂x, which reaches all nodes of the elements around a. Rows gather: each has one
/// writer.
void ElementExecutor::assemble_average(const BlockState& state, BlockMatrix& matrix) {
  if (reach_.begin.empty()) find_reach();
  with_element_kind(block_.law, block_.nodes, [&]<Law L, int N>() {
    if constexpr (N == 4 && L != Law::corotational)
      pool_.for_ranges(block_.patch_count(), 1, [&](int patch, int) { average_gradients_of_patch<L>(state, patch); });
  });
  const auto for_nodes = [&](int grain, const auto& act) {
    pool_.for_ranges(set_.node_count(), grain, [&](int begin, int end) {
      for (int node = begin; node < end; ++node) act(node);
    });
  };
  for_nodes(64, [&](int node) { sum_average_gradient(node); });
  const double factor = bulk_factor(state);
  for_nodes(16, [&](int node) { assemble_average_row(node, factor, matrix); });
}

}  // namespace fascia
