#include "core/base/index.hpp"
#include "core/base/parallel_copy.hpp"
#include "core/executor/executor.hpp"
#include "core/node/node_load.hpp"

#include <algorithm>

/// Linearization, all that products with the tangent need of a state; products and entries.
namespace fascia {

namespace {

constexpr int kNodeGrain = 256;

/// I + D of each node.
void turn(ThreadPool& pool, const FrameMatrices& D, std::vector<Mat3d>& Q) {
  Q.resize(D.size());
  pool.for_ranges(static_cast<int>(Q.size()), kNodeGrain, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) Q[at(node)] = Mat3d::identity() + D[at(node)];
  });
}

}  // namespace

std::span<const Vec3d> CpuExecutor::translations_of(std::span<const double> d) {
  translations_.resize(see_translations_ ? at(set_.node_count()) : 0);
  pool_.for_ranges(static_cast<int>(translations_.size()), kNodeGrain, [&](int begin, int end) {
    for (int node = begin; node < end; ++node)
      std::copy_n(d.data() + set_.dofs.begin(node), 3, translations_[at(node)].v);
  });
  return translations_;
}

BlockDirection CpuExecutor::direction_of(std::span<const double> d, const std::vector<Mat3d>& Q) {
  motions_.resize(see_motions_ ? at(set_.node_count()) * 12 : 0);
  if (see_motions_)
    pool_.for_ranges(set_.node_count(), kNodeGrain, [&](int begin, int end) {
      for (int node = begin; node < end; ++node) {
        double* motion = motions_.data() + at(node) * 12;
        const double* dn = d.data() + set_.dofs.begin(node);
        const Mat3d W = frame_variation(set_.dofs.kind(node), dn + 3, Q[at(node)]);
        for (int i = 0; i < 3; ++i) {
          motion[i] = dn[i];
          for (int j = 0; j < 3; ++j) motion[3 + 3 * i + j] = W(i, j);
        }
      }
    });
  return {d, translations_of(d), motions_};
}

void CpuExecutor::linearize(const State& state, const StrainHistory& history, Tangent tangent, Linearization& out,
                            bool tethers_turn, const TakenStep* taken) {
  out.tangent = tangent;
  out.inverse_step = history.inverse_step;
  out.loads.clear();
  if (tangent == Tangent::material) taken = nullptr;
  linearize_blocks(state, history, taken, out);
  const std::vector<Mat3d>& turning = taken != nullptr && see_motions_ ? extrapolated_L_ : node_L_;
  turn(pool_, state.D, out.Q);
  out.node_blocks.resize(set_.dofs.block_total());
  pool_.for_ranges(set_.node_count(), kNodeGrain, [&](int begin, int end) {
    std::fill(out.node_blocks.data() + set_.dofs.block_begin(begin),
              out.node_blocks.data() + set_.dofs.block_begin(end), 0.0);
    for (int node = begin; node < end; ++node) {
      double* block = out.node_blocks.data() + set_.dofs.block_begin(node);
      if (tangent == Tangent::material || set_.dofs.kind(node) != FrameKind::rigid) continue;
      const Mat3d L = tethers_turn || tether_L_.empty() ? turning[at(node)] : turning[at(node)] - tether_L_[at(node)];
      const Mat3d rr = sym(L) - Mat3d::diagonal(trace(L));
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) block[6 * (3 + i) + 3 + j] = rr(i, j);
    }
  });
  springs_.add_blocks(state, out.tangent, out.node_blocks);
  copy_into(pool_, state.u, out.u);
  copy_into(pool_, state.D.values(), out.D);
  if (see_state_again_) copy_into(pool_, history.E, out.E);
  copy_into(pool_, history.given, out.given);
}

/// Blocks keep what they need; where stresses are extrapolated, what they do to turning frames is kept too.
void CpuExecutor::linearize_blocks(const State& state, const StrainHistory& history, const TakenStep* taken,
                                   Linearization& out) {
  out.kept_begin.assign(1, 0);
  for_each_block([&](const auto& block, std::size_t) {
    out.kept_begin.push_back(out.kept_begin.back() + block.kept_size(taken != nullptr));
  });
  out.kept.resize(out.kept_begin.back());
  BlockDirection step;
  if (taken != nullptr) {
    turn(pool_, taken->D, out.Q);  // those of the state follow
    step = direction_of(taken->d, out.Q);
  }
  for_each_block([&](auto& block, std::size_t b) {
    const BlockState now = state_of(state, history, b);
    const std::span<double> kept =
        std::span(out.kept).subspan(out.kept_begin[b], out.kept_begin[b + 1] - out.kept_begin[b]);
    if (taken == nullptr) return block.linearize(now, nullptr, nullptr, kept);
    BlockState start = now;
    start.u = taken->u;
    start.D = taken->D.values();
    block.linearize(now, &start, &step, kept);
  });
  if (taken == nullptr || !see_motions_) return;
  extrapolated_L_.resize(at(set_.node_count()));
  pool_.for_ranges(set_.node_count(), kNodeGrain, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      if (set_.dofs.kind(node) != FrameKind::rigid) continue;
      const Mat3d N = sum_at(node).N;
      extrapolated_L_[at(node)] = N + times_transpose(N, state.D[at(node)]);  // N Qᵀ
    }
  });
}

double CpuExecutor::largest_step(const State& state, std::span<const double> direction, const std::vector<Mat3d>& Q) {
  std::vector<UserExecutor>& blocks = std::get<Several<UserExecutor>>(blocks_);
  if (blocks.empty()) return 1;
  const BlockDirection motion = direction_of(direction, Q);
  double longest = 1;
  for (UserExecutor& block : blocks) longest = std::min(longest, block.largest_step(state_of(state, {}, 0), motion));
  return longest;
}

double CpuExecutor::largest_spin(std::span<const double> direction) {
  const BlockDirection motion{direction, translations_of(direction), {}};
  double largest = 0;
  for_each_block([&](auto& block, std::size_t) { largest = std::max(largest, block.largest_spin(motion)); });
  return largest;
}

void CpuExecutor::multiply(const Linearization& lin, std::span<const double> x, std::span<double> y) {
  const BlockDirection direction = direction_of(x, lin.Q);
  for_each_block([&](auto& block, std::size_t b) { block.compute_product(state_of(lin, b), direction); });
  pool_.for_ranges(set_.node_count(), kNodeGrain, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      const NodeSum sum = sum_at(node);
      const FrameKind kind = set_.dofs.kind(node);
      const int n = set_.dofs.size(node);
      const double* block = lin.node_blocks.data() + set_.dofs.block_begin(node);
      const double* xn = x.data() + set_.dofs.begin(node);
      double* yn = y.data() + set_.dofs.begin(node);
      for (int i = 0; i < n; ++i) {
        yn[i] = i < 3 ? sum.force[i] : 0.0;
        for (int j = 0; j < n; ++j) yn[i] += block[n * i + j] * xn[j];
      }
      add_moment(kind, sum.N, lin.Q[at(node)], yn + 3);
      if (kind == FrameKind::rigid)
        for (int i = 0; i < 3; ++i) yn[3 + i] += sum.torque[i];
    }
  });
  lin.loads.add_product(set_, lin.Q, x, y);
}

void CpuExecutor::assemble(const Linearization& lin, BlockMatrix& matrix_out, Entries entries) {
  matrix_out.set_condensed(false);
  for_each_block([&](auto& block, std::size_t b) { block.assemble(state_of(lin, b), matrix_out, entries); });
  pool_.for_ranges(set_.node_count(), kNodeGrain, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      double* diagonal = matrix_out.block(matrix_out.diagonal(node));
      const double* own = lin.node_blocks.data() + set_.dofs.block_begin(node);
      for (int k = 0; k < set_.dofs.size(node) * set_.dofs.size(node); ++k) diagonal[k] += own[k];
    }
  });
  lin.loads.add_to(matrix_out, lin.Q);
  matrix_out.mirror_lower(pool_);
}

}  // namespace fascia
