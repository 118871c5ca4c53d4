#include "core/base/errors.hpp"
#include "core/executor/element_batch.hpp"
#include "core/linear/block_matrix.hpp"
#include "core/math/lane_rows.hpp"
#include "core/math/transpose_lanes.hpp"

#include <algorithm>
#include <limits>

namespace fascia {

using namespace kernels;

namespace {

/// Blocks of node pairs (a, b ≤ a) of an element, in this order.
constexpr int pair_count(int nodes) { return nodes * (nodes + 1) / 2; }

/// Adds the stiffness of a batch, by columns: each unit motion gives the forces on the nodes that come after.
template <class BatchTangent>
void add_columns(BatchTangent& tangent, const ElementBlock& block, int batch, int half, Mat3<Lanes>* K) {
  constexpr int N = BatchTangent::kNodes;
  const int n = nodes_of<N>(block), points = tangent.points.count();
  Mat3<Lanes> dF[BatchPoints<N>::kPoints], dP[BatchPoints<N>::kPoints];
  for (int b = 0; b < n; ++b) {
    for (int j = 0; j < 3; ++j) {
      for (int q = 0; q < points; ++q) {
        dF[q] = {};
        const Vec3<Lanes> g = gradient(block.gradient_of(batch, q), b, half);
        for (int k = 0; k < 3; ++k) dF[q](j, k) = g[k];
      }
      tangent.differential(dF, dP);
      for (int a = b; a < n; ++a) {
        Vec3<Lanes> column;
        for (int q = 0; q < points; ++q)
          column += dP[q] * gradient(block.gradient_of(batch, q), a, half) * tangent.points.v(q);
        for (int i = 0; i < 3; ++i) K[pair_count(a) + b](i, j) += column[i];
      }
    }
  }
}

/// Adds the stiffness of a batch by the blocks of its points.
template <Law L, int N>
void add_blocks(const BatchTangent<L, N>& tangent, const ElementBlock& block, int batch, int half, bool full,
                Mat3<Lanes>* K) {
  const int n = nodes_of<N>(block);
  for (int q = 0; q < tangent.points.count(); ++q) {
    const ElasticPoint<L, Lanes>& point = tangent.point(q);
    const ElementStiffness<L, Lanes> stiffness(point, tangent.m, tangent.volumetric_modulus(), full, block.damped);
    const Lanes v = tangent.points.v(q);
    typename ElementStiffness<L, Lanes>::Node node[kRoom<N>];
    for (int a = 0; a < n; ++a) node[a] = stiffness.node(gradient(block.gradient_of(batch, q), a, half));
    for (int a = 0; a < n; ++a)
      for (int b = 0; b <= a; ++b) K[pair_count(a) + b] += stiffness.block(node[a], node[b]) * v;
  }
}

constexpr int kVertexBlock = 9;  ///< numbers
constexpr int kPairsAhead = 4;   ///< of pairs of nodes whose blocks are fetched before they are added to

/// Adds the blocks of a batch's pair of nodes to where each lane has its own.
/// @param transposed  above the diagonal
void add_pair(const Mat3<Lanes>& K, const std::uint32_t* slot, bool transposed, double* values) {
  Lanes entry[9];
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) entry[3 * r + c] = transposed ? K(c, r) : K(r, c);
  for (int first = 0; first + kBatchWidth <= 9; first += kBatchWidth) {
    Lanes part[kBatchWidth];
    for (int k = 0; k < kBatchWidth; ++k) part[k] = entry[first + k];
    transpose_lanes(part);
    for (int lane = 0; lane < kBatchWidth; ++lane) {
      double* out = values + slot[lane] + first;
      for (int k = 0; k < kBatchWidth; ++k) out[k] += part[lane].v[k];
    }
  }
  for (int lane = 0; lane < kBatchWidth; ++lane) values[slot[lane] + 8] += entry[8].v[lane];
}

/// The same where rows of blocks are `stride` apart, since some of their nodes turn too.
void add_wide_pair(const Mat3<Lanes>& K, const std::uint32_t* slot, const std::uint8_t* stride, bool transposed,
                   double* values) {
  for (int lane = 0; lane < kBatchWidth; ++lane)
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) values[slot[lane] + stride[lane] * r + c] += (transposed ? K(c, r) : K(r, c)).v[lane];
}

}  // namespace

/// Has the processor fetch the blocks of lanes from a place on.
inline void ElementExecutor::prefetch_pair(std::size_t place, const double* values) const {
  if (place + kBatchWidth > pair_slot_.size()) return;
  for (int lane = 0; lane < kBatchWidth; ++lane) prefetch_to_add(values + pair_slot_[place + at(lane)], kVertexBlock);
}

/// Adds the blocks of a batch to the matrix. Inlined always: as a call, tetrahedra of ten nodes took a third longer.
template <int N>
[[gnu::always_inline]] inline void ElementExecutor::add_pairs(const Mat3<Lanes>* K, int batch, int half,
                                                              BlockMatrix& matrix) const {
  const int pairs = pair_count(nodes_of<N>(block_));
  const std::size_t first_pair = at(batch) * at(pairs) * kElementLanes + half * kBatchWidth;
  const std::uint32_t* slot = pair_slot_.data() + first_pair;
  for (int pair = 0; pair < pairs; ++pair) {
    prefetch_pair(first_pair + at(pair + kPairsAhead) * kElementLanes, matrix.values());
    const std::uint8_t* stride =
        pair_stride_.empty() ? nullptr : pair_stride_.data() + first_pair + pair * kElementLanes;
    if (stride == nullptr || std::all_of(stride, stride + kBatchWidth, [](std::uint8_t length) { return length == 3; }))
      add_pair(K[pair], slot + pair * kElementLanes, matrix.fills_upper(), matrix.values());
    else
      add_wide_pair(K[pair], slot + pair * kElementLanes, stride, matrix.fills_upper(), matrix.values());
  }
}

/// K has room for the pairs of the largest element only where it must: a linear tetrahedron's stay in registers' reach.
template <Law L, int N>
[[gnu::flatten]] void ElementExecutor::assemble_patch(const BlockState& state, int patch, BlockMatrix& matrix) {
  gather_patch(state.u, patch, slot_u_);
  const auto first = at(block_.patch_begin[at(patch)]);
  const auto nodes = block_.nodes_of_patch(patch);
  for (int batch = block_.patch_batch[at(patch)]; batch < block_.patch_batch[at(patch) + 1]; ++batch) {
    for (int half = 0; half < kBatches; ++half) {
      Vec3<Lanes> u[kRoom<N>];
      gather<N>(block_, batch, half, slot_u_.data() + first, u);
      const Lanes pressure = block_.averaged ? mean_pressure(block_, batch, half, nodes, node_pressure_) : Lanes(0);
      BatchTangent<L, N> tangent(block_, batch, half, u, state, pressure);
      Mat3<Lanes> K[pair_count(kRoom<N>)];
      if constexpr (ElementStiffness<L, Lanes>::kOfPoints)
        add_blocks(tangent, block_, batch, half, state.tangent == Tangent::full, K);
      else
        add_columns(tangent, block_, batch, half, K);
      add_pairs<N>(K, batch, half, matrix);
    }
  }
}

/// Beside assemble_patch(), which gathered the patch.
template <int N>
void ElementExecutor::assemble_penalty(const BlockState& state, int patch, BlockMatrix& matrix) {
  const auto first = at(block_.patch_begin[at(patch)]);
  for (int batch = block_.patch_batch[at(patch)]; batch < block_.patch_batch[at(patch) + 1]; ++batch) {
    for (int half = 0; half < kBatches; ++half) {
      Vec3<Lanes> u[kRoom<N>];
      gather<N>(block_, batch, half, slot_u_.data() + first, u);
      const PenaltyTangent<N> tangent(block_, batch, half, u, state.tangent == Tangent::full);
      Mat3<Lanes> K[pair_count(kRoom<N>)];
      add_columns(tangent, block_, batch, half, K);
      add_pairs<N>(K, batch, half, matrix);
    }
  }
}

void ElementExecutor::find_pair_slots(const BlockMatrix& matrix) {
  const int pairs = pair_count(block_.nodes);
  if (matrix.value_count() > std::numeric_limits<std::uint32_t>::max())
    throw InputError("the matrix has more than 4e9 entries; use fewer elements");
  pattern_ = matrix.pattern();
  pair_slot_.resize(at(block_.batch_count()) * at(pairs) * kElementLanes);
  const auto turns = [&](int node) { return matrix.dofs().kind(node) != FrameKind::vertex; };
  if (std::any_of(block_.patch_node.begin(), block_.patch_node.end(), turns)) pair_stride_.resize(pair_slot_.size());
  for (int patch = 0; patch < block_.patch_count(); ++patch) {
    const auto nodes = block_.nodes_of_patch(patch);
    for (int batch = block_.patch_batch[at(patch)]; batch < block_.patch_batch[at(patch) + 1]; ++batch) {
      for (int lane = 0; lane < kElementLanes; ++lane) {
        for (int a = 0; a < block_.nodes; ++a) {
          for (int b = 0; b <= a; ++b) {
            const int i = nodes[block_.local_of(batch)[a * kElementLanes + lane]];
            const int j = nodes[block_.local_of(batch)[b * kElementLanes + lane]];
            const int index = matrix.fills_upper() ? matrix.find(j, i) : matrix.find(i, j);
            const std::size_t place = (at(batch) * at(pairs) + at(pair_count(a) + b)) * kElementLanes + at(lane);
            pair_slot_[place] = static_cast<std::uint32_t>(matrix.block(index) - matrix.values());
            if (!pair_stride_.empty())
              pair_stride_[place] = static_cast<std::uint8_t>(matrix.dofs().size(matrix.fills_upper() ? i : j));
          }
        }
      }
    }
  }
}

void ElementExecutor::assemble(const BlockState& state, BlockMatrix& matrix, Entries /*entries*/) {
  if (pattern_ != matrix.pattern()) find_pair_slots(matrix);
  if (block_.averaged) average(state);
  with_element_kind(block_.law, block_.nodes, [&]<Law L, int N>() {
    for (std::size_t c = 0; c + 1 < block_.color_begin.size(); ++c) {
      const int first = block_.color_begin[c];
      pool_.for_ranges(block_.color_begin[c + 1] - first, 1, [&](int i, int) {
        const int patch = block_.color_patch[at(first + i)];
        assemble_patch<L, N>(state, patch, matrix);
        if (block_.penalised) assemble_penalty<N>(state, patch, matrix);
      });
    }
  });
  if (block_.averaged) assemble_average(state, matrix);
}

}  // namespace fascia
