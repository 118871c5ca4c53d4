#include "core/executor/point_executor.hpp"

#include "core/base/errors.hpp"
#include "core/executor/point_columns.hpp"
#include "core/executor/point_kernels.hpp"
#include "core/linear/block_matrix.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

/// Entries of the tangent of points.
namespace fascia {

using namespace kernels;

namespace {

/// Adds the sums over lanes of so many batches.
void add_lane_sums(const double* batches, int count, double* out) {
  constexpr int W = kBatchWidth;
  int k = 0;
  for (; k + W <= count; k += W) {
    Lanes part[W];
    for (int l = 0; l < W; ++l) part[l] = Lanes::load(batches + (k + l) * W);
    transpose_lanes(part);
    Lanes sum = part[0];
    for (int l = 1; l < W; ++l) sum += part[l];
    store_anywhere(out + k, load_anywhere<Lanes::Register>(out + k) + sum.v);
  }
  for (; k < count; ++k) out[k] += lane_sum(Lanes::load(batches + k * W));
}

}  // namespace

/// Frames of a group that shares them, and the moduli of its points, in somebody's memory.
struct PointExecutor::GroupOfFrames {
  PointFrame* frames;   ///< (slots × batches)
  PointModuli* moduli;  ///< (batches)

  const PointFrame& of(int batch, int slot) const { return frames[slot * kBatches + batch]; }
};

/// These of one group.
struct PointExecutor::FramesOfOne {
  std::array<PointFrame, at(kMaxSlots* kBatches)> frames;
  PointModuli moduli[kBatches];

  GroupOfFrames view() { return {frames.data(), moduli}; }
};

/// These of all groups that share theirs, where nodes assemble: a frame of a group is asked for with each of those
/// before it.
struct PointExecutor::FramesOfAll {
  std::vector<int> first_slot, number;  ///< of each group, among these groups
  std::vector<PointFrame> frames;
  std::vector<PointModuli> moduli;

  FramesOfAll(const PointSet& set, const LaneFrames& lanes) {
    int slots = 0, groups = 0;
    for (int group = 0; group < set.group_count(); ++group) {
      first_slot.push_back(slots);
      number.push_back(groups);
      if (lanes.count(group) > 0) continue;
      slots += static_cast<int>(set.nodes(group).size());
      ++groups;
    }
    frames.resize(at(slots * kBatches));
    moduli.resize(at(groups * kBatches));
  }
  GroupOfFrames of(int group) {
    return {&frames[at(first_slot[at(group)] * kBatches)], &moduli[at(number[at(group)] * kBatches)]};
  }
};

/// Finds the blocks, in the order in which assembly meets them.
void PointExecutor::find_pairs(const BlockMatrix& matrix) {
  const LaneFrames& lanes = frames_.lanes();
  const auto add = [&](int first, int second) {  // no later in a group
    pairs_.push_back(matrix.place(matrix.fills_upper() ? matrix.find(first, second) : matrix.find(second, first)));
  };
  if (matrix.value_count() > BlockMatrix::kMostValues)
    throw InputError("the matrix has more than 3.8e10 entries; use fewer points or frames");
  pattern_ = matrix.pattern();
  pairs_.clear();
  pair_begin_.assign(at(set_.slot_count()), 0);
  for (int group = 0; group < set_.group_count(); ++group) {
    if (lanes.has_blocks(group)) {
      pair_begin_[at(set_.slot_begin[at(group)])] = pairs_.size();
      const std::uint16_t* start = lanes.starts(group);
      for (int b = 0; b < lanes.count(group); ++b)
        for (int a = b; a < lanes.count(group); ++a)
          for (int lane = 0; lane < kGroupSize; ++lane)
            add(lanes.node_at(group, start[b * kGroupSize + lane]), lanes.node_at(group, start[a * kGroupSize + lane]));
      continue;
    }
    for (int b = set_.slot_begin[at(group)]; b < set_.slot_begin[at(group + 1)]; ++b) {
      pair_begin_[at(b)] = pairs_.size();
      for (int a = b; a < set_.slot_begin[at(group + 1)]; ++a)
        if (together(a, b)) add(set_.slot_node[at(b)], set_.slot_node[at(a)]);
    }
  }
}

/// Sets the moduli of a batch: all that assembly asks of a law, so that the rest is compiled for all laws at once.
template <Law L>
[[gnu::noinline, gnu::flatten]] void PointExecutor::set_moduli_of(const BlockState& state, int group, int batch,
                                                                  PointModuli& moduli) const {
  const double* kept = kept_of(state, group);
  moduli.set(matrix(kept, kKeptH, batch), symmetric_matrix(kept, kKeptS, batch),
             material<L>(set_, group, batch, state, targets_), state.tangent);
}

void PointExecutor::set_moduli(const BlockState& state, int group, int batch, PointModuli& moduli) const {
  with_point_law(rule_of(group).law, [&]<Law L>() { set_moduli_of<L>(state, group, batch, moduli); });
}

template <Stabilization Tie>
PointTie PointExecutor::tie_of(const BlockState& state, int group, int batch) const {
  const double *kept = kept_of(state, group), *material = set_.material_of_group(group);
  const bool tether = rule_of(group).law == Law::tether;
  return {kept_motion<Tie>(kept, batch), kept_stress<Tie>(kept, batch), row(material, kVolume, batch),
          tether ? Lanes(0) : row(material, kStabilization, batch)};
}

void PointExecutor::set_frames(const BlockState& state, int group, const GroupOfFrames& frames) const {
  const auto nodes = set_.nodes(group);
  for (int a = 0; a < static_cast<int>(nodes.size()); ++a) {
    const Mat3<Lanes> Q = broadcast(Mat3d::identity() + turn_of(state, nodes[at(a)]));
    const double* shape = set_.shape_of_slot(set_.slot_begin[at(group)] + a);
    for (int batch = 0; batch < kBatches; ++batch)
      frames.frames[a * kBatches + batch].set(set_.dofs.kind(nodes[at(a)]), shape, false, batch, Q);
  }
  for (int batch = 0; batch < kBatches; ++batch) set_moduli(state, group, batch, frames.moduli[batch]);
}

/// The degrees of freedom of slot b give dP and dY, and these the forces on slots a ≥ b of the group, which go into
/// blocks of that pair of nodes alone.
/// All that it calls is inlined: matrices of lanes that are passed by memory take as long as what is done with them.
template <Stabilization Tie>
[[gnu::flatten]] void PointExecutor::assemble_slot(const BlockState& state, int group, int b,
                                                   const GroupOfFrames& frames, Entries entries,
                                                   BlockMatrix& matrix_out) const {
  constexpr bool kBlend = Tie != Stabilization::none;
  const auto nodes = set_.nodes(group);
  const int n = static_cast<int>(nodes.size()), first_slot = set_.slot_begin[at(group)];
  const bool upper = matrix_out.fills_upper();
  const int columns = set_.dofs.size(nodes[at(b)]), end = entries == Entries::all ? n : b + 1;
  const std::uint32_t* pair = pairs_.data() + pair_begin_[at(first_slot + b)];
  for (int a = b, k = 0; a < end; ++a)
    if (together(first_slot + a, first_slot + b))
      prefetch_to_add(matrix_out.at_place(pair[k++]), set_.dofs.size(nodes[at(a)]) * columns);
  LaneMatrix dP[kBatches][kMostDofs], dY[kBatches][kBlend ? kMostDofs : 1];
  with_frame(set_.dofs.kind(nodes[at(b)]), [&]<FrameKind Frame>() {
    for (int batch = 0; batch < kBatches; ++batch)
      stress_columns<Tie, Frame>(frames.moduli[batch], tie_of<Tie>(state, group, batch), state.tangent,
                                 frames.of(batch, b), dP[batch], dY[batch]);
  });
  for (int a = b; a < end; ++a) {
    if (!together(first_slot + a, first_slot + b)) continue;
    const int rows = set_.dofs.size(nodes[at(a)]), stride = (upper ? 1 : columns) * kBatchWidth;
    LaneArray<kMostDofs * kMostDofs> block;
    with_frame(set_.dofs.kind(nodes[at(a)]), [&]<FrameKind Frame>() {
      for (int batch = 0; batch < kBatches; ++batch)
        for (int k = 0; k < columns; ++k) {
          double* entry = block.numbers + (upper ? k * rows : k) * kBatchWidth;
          put_column<kBlend, Frame>(frames.of(batch, a), dP[batch][k], dY[batch][kBlend ? k : 0],
                                    [&](int i, const Lanes& value) {
                                      double* to = entry + i * stride;
                                      (batch == 0 ? value : Lanes::load(to) + value).store(to);
                                    });
        }
    });
    add_lane_sums(block.numbers, rows * columns, matrix_out.at_place(*pair++));
  }
}

void PointExecutor::assemble_slot_of(const BlockState& state, int group, int b, const GroupOfFrames& frames,
                                     Entries entries, BlockMatrix& matrix_out) const {
  with_stabilization(rule_of(group).stabilization,
                     [&]<Stabilization Tie>() { assemble_slot<Tie>(state, group, b, frames, entries, matrix_out); });
}

void PointExecutor::assemble_group(const BlockState& state, int group, Entries entries, BlockMatrix& matrix_out) const {
  FramesOfOne own;
  set_frames(state, group, own.view());
  const int n = static_cast<int>(set_.nodes(group).size());
  for (int b = 0; b < n; ++b) assemble_slot_of(state, group, b, own.view(), entries, matrix_out);
}

/// Fills all blocks of which a node is the first.
void PointExecutor::assemble_node(const BlockState& state, int node, Entries entries, BlockMatrix& matrix_out) const {
  for (int k = set_.node_slot_begin[at(node)]; k < set_.node_slot_begin[at(node + 1)]; ++k) {
    const int slot = set_.node_slot[at(k)], group = group_of_slot_[at(slot)], b = slot - set_.slot_begin[at(group)];
    if (frames_.lanes().count(group) > 0) continue;
    assemble_slot_of(state, group, b, frames_of_all_->of(group), entries, matrix_out);
  }
}

/// Lane by lane: each has blocks of its own. All frames of the group are of one kind.
template <Stabilization Tie, FrameKind Frame>
[[gnu::flatten]] void PointExecutor::assemble_lanes(const BlockState& state, int group, Entries entries,
                                                    BlockMatrix& matrix_out) const {
  constexpr bool kBlend = Tie != Stabilization::none;
  constexpr int kDofs = dof_count(Frame);
  const LaneFrames& lanes = frames_.lanes();
  const int n = lanes.count(group);
  const std::uint16_t* starts = lanes.starts(group);
  const bool upper = matrix_out.fills_upper();
  std::array<PointFrame, LaneFrames::kMostFrames> frames;
  PointModuli moduli;
  for (int batch = 0; batch < kBatches; ++batch) {
    const PointTie tie = tie_of<Tie>(state, group, batch);
    for (int a = 0; a < n; ++a) {
      Lanes D[9];
      const std::uint16_t* own = starts + a * kGroupSize + batch * kBatchWidth;
      gather_rows([&](int lane) { return &turn_of(state, lanes.node_at(group, own[lane]))(0, 0); }, D);
      frames[at(a)].set(Frame, lanes.shape(group) + a * lanes.shape_rows(group) * kGroupSize, lanes.carries(group),
                        batch, Mat3<Lanes>::identity() + matrix_of(D));
    }
    set_moduli(state, group, batch, moduli);
    const std::uint32_t* pair = pairs_.data() + pair_begin_[at(set_.slot_begin[at(group)])] + batch * kBatchWidth;
    const std::uint32_t* end = pair + n * (n + 1) / 2 * kGroupSize;
    for (int b = 0; b < n; ++b) {
      LaneMatrix dP[kDofs], dY[kBlend ? kDofs : 1];
      stress_columns<Tie, Frame>(moduli, tie, state.tangent, frames[at(b)], dP, dY);
      for (int a = b; a < n; ++a, pair += kGroupSize) {
        if (entries == Entries::diagonal && a > b) continue;
        for (int lane = 0; lane < kBatchWidth && pair + kGroupSize < end && entries == Entries::all; ++lane)
          prefetch_to_add(matrix_out.at_place(pair[kGroupSize + lane]), kDofs * kDofs);
        LaneArray<kDofs * kDofs> block;
        for (int k = 0; k < kDofs; ++k) {
          put_column<kBlend, Frame>(frames[at(a)], dP[k], dY[kBlend ? k : 0], [&](int i, const Lanes& value) {
            block.set(upper ? k * kDofs + i : i * kDofs + k, value);
          });
        }
        add_to_rows<kDofs * kDofs>(block, [&](int lane) { return matrix_out.at_place(pair[lane]); });
      }
    }
  }
}

void PointExecutor::assemble_one(const BlockState& state, int group, Entries entries, BlockMatrix& matrix_out) const {
  const LaneFrames& lanes = frames_.lanes();
  if (!lanes.has_blocks(group)) return assemble_group(state, group, entries, matrix_out);
  with_stabilization(rule_of(group).stabilization, [&]<Stabilization Tie>() {
    if (lanes.kind(group) == FrameKind::rigid)
      assemble_lanes<Tie, FrameKind::rigid>(state, group, entries, matrix_out);
    else
      assemble_lanes<Tie, FrameKind::affine>(state, group, entries, matrix_out);
  });
}

/// All blocks by nodes, of groups whose colours are small.
void PointExecutor::assemble_by_nodes(const BlockState& state, Entries entries, BlockMatrix& matrix_out) {
  if (frames_of_all_ == nullptr) frames_of_all_ = std::make_shared<FramesOfAll>(set_, frames_.lanes());
  pool_.for_ranges(set_.group_count(), 1, [&](int group, int) {
    if (frames_.lanes().count(group) > 0) return;
    set_frames(state, group, frames_of_all_->of(group));
  });
  pool_.for_ranges(set_.node_count(), 1, [&](int node, int) { assemble_node(state, node, entries, matrix_out); });
}

/// Patches of one colour at the same time, then groups of one; nodes, where colours have few groups. A patch clears the
/// rows that it is the first to add to, which then are near: cleared all at once they would go to memory and back.
void PointExecutor::assemble(const BlockState& state, BlockMatrix& matrix_out, Entries entries) {
  const LaneFrames& lanes = frames_.lanes();
  if (pattern_ != matrix_out.pattern()) find_pairs(matrix_out);
  const auto assemble_groups = [&](std::span<const int> groups) {
    for (const int group : groups) assemble_one(state, group, entries, matrix_out);
  };
  constexpr int kRowGrain = 64;
  const std::span<const int> others = lanes.nodes_of_no_patch();
  pool_.for_ranges(static_cast<int>(others.size()), kRowGrain, [&](int begin, int end) {
    for (const int node : others.subspan(at(begin), at(end - begin))) matrix_out.clear_row(node);
  });
  const Coloring& patches = lanes.colors();
  for (std::size_t c = 0; c + 1 < patches.begin.size(); ++c)
    pool_.for_chunks(patches.begin[c + 1] - patches.begin[c], [&](int i) {
      const int patch = patches.item[at(patches.begin[c] + i)];
      for (const int node : lanes.new_nodes(patch)) matrix_out.clear_row(node);
      assemble_groups(lanes.groups(patch));
    });
  const Coloring& shared = frames_.shared_colors();
  if (!group_of_slot_.empty()) return assemble_by_nodes(state, entries, matrix_out);
  for (std::size_t c = 0; c + 1 < shared.begin.size(); ++c) {
    const std::span<const int> groups =
        std::span(shared.item).subspan(at(shared.begin[c]), at(shared.begin[c + 1] - shared.begin[c]));
    pool_.for_ranges(static_cast<int>(groups.size()), 8,
                     [&](int begin, int end) { assemble_groups(groups.subspan(at(begin), at(end - begin))); });
  }
}

}  // namespace fascia
