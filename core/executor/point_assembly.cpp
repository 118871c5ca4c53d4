#include "core/executor/point_executor.hpp"

#include "core/base/errors.hpp"
#include "core/executor/point_kernels.hpp"
#include "core/linear/block_matrix.hpp"

#include <algorithm>
#include <array>

/// Entries of the tangent of points.
namespace fascia {

using namespace kernels;

namespace {

/// A frame as it moves the points of a batch; nothing at first.
struct PointFrame {
  FrameKind kind;
  LaneArray<22> rows;  ///< w, g (3), A (9): B of an affine frame, else Q B; w Q (9) with Q = I + D

  void set(FrameKind k, const double* shape, bool carries, int batch, const Mat3<Lanes>& Q) {
    kind = k;
    const Vec3<Lanes> g = vector(shape, 1, batch);
    Mat3<Lanes> A = carries ? outer(vector(shape, 4, batch), g) + Mat3<Lanes>::diagonal(row(shape, 0, batch))
                            : kernels::matrix(shape, 4, batch);
    if (kind != FrameKind::affine) A = Q * A;
    rows.set(0, row(shape, 0, batch));
    for (int i = 0; i < 3; ++i) {
      rows.set(1 + i, g[i]);
      for (int j = 0; j < 3; ++j) {
        rows.set(4 + 3 * i + j, A(i, j));
        rows.set(13 + 3 * i + j, Q(i, j) * row(shape, 0, batch));
      }
    }
  }
  Lanes w() const { return rows[0]; }
  Lanes g(int i) const { return rows[1 + i]; }
  Lanes A(int i, int j) const { return rows[4 + 3 * i + j]; }
  Lanes Q_weighted(int i, int j) const { return rows[13 + 3 * i + j]; }

  static Vec3<Lanes> vector(const double* shape, int first, int batch) {
    return {{row(shape, first, batch), row(shape, first + 1, batch), row(shape, first + 2, batch)}};
  }
};

/// The motion of a point for a unit of one degree of freedom of a frame; rigid ones turn by e × of each column.
template <bool Blend>
PointMotion<Lanes> unit_motion(const PointFrame& f, int dof) {
  PointMotion<Lanes> d;
  if (dof < 3) {
    for (int j = 0; j < 3; ++j) d.H(dof, j) = f.g(j);
  } else if (f.kind == FrameKind::rigid) {
    const int next = (dof - 2) % 3, last = (dof - 1) % 3;
    for (int j = 0; j < 3; ++j) {
      d.H(next, j) = -f.A(last, j);
      d.H(last, j) = f.A(next, j);
      if constexpr (Blend) {
        d.Dbar(next, j) = -f.Q_weighted(last, j);
        d.Dbar(last, j) = f.Q_weighted(next, j);
      }
    }
  } else {
    const int q = (dof - 3) / 3, i = (dof - 3) % 3;
    for (int j = 0; j < 3; ++j) d.H(i, j) = f.A(q, j);
    if constexpr (Blend) d.Dbar(i, q) = f.w();
  }
  return d;
}

/// Calls put(degree of freedom, what dP and dY are on a frame of this kind there).
template <bool Blend, FrameKind Frame, class Put>
inline void put_column(const PointFrame& f, const LaneMatrix& dP, const LaneMatrix& dY, const Put& put) {
  for (int i = 0; i < 3; ++i) put(i, dP(i, 0) * f.g(0) + dP(i, 1) * f.g(1) + dP(i, 2) * f.g(2));
  if constexpr (Frame == FrameKind::vertex) return;
  // N = dP Aᵀ + w dY, of rigid frames with w dY Qᵀ, whose torque is its axial vector.
  const auto moment = [&](int i, int j) {
    Lanes sum = dP(i, 0) * f.A(j, 0) + dP(i, 1) * f.A(j, 1) + dP(i, 2) * f.A(j, 2);
    if constexpr (Blend && Frame == FrameKind::rigid)
      sum += dY(i, 0) * f.Q_weighted(j, 0) + dY(i, 1) * f.Q_weighted(j, 1) + dY(i, 2) * f.Q_weighted(j, 2);
    else if constexpr (Blend)
      sum += dY(i, j) * f.w();
    return sum;
  };
  if constexpr (Frame == FrameKind::rigid) {
    put(3, moment(2, 1) - moment(1, 2));
    put(4, moment(0, 2) - moment(2, 0));
    put(5, moment(1, 0) - moment(0, 1));
  }
  if constexpr (Frame == FrameKind::affine) {
    for (int q = 0; q < 3; ++q)
      for (int i = 0; i < 3; ++i) put(3 + 3 * q + i, moment(i, q));
  }
}

/// Calls act.operator()<FrameKind>().
template <class Act>
void with_frame(FrameKind kind, const Act& act) {
  switch (kind) {
    case FrameKind::vertex:
      return act.template operator()<FrameKind::vertex>();
    case FrameKind::rigid:
      return act.template operator()<FrameKind::rigid>();
    case FrameKind::affine:
      return act.template operator()<FrameKind::affine>();
  }
}

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

/// Frames of a group that shares them, from one on.
struct PointExecutor::GroupOfFrames {
  std::array<PointFrame, kMaxSlots> frames[kBatches];

  const PointFrame& of(int batch, int slot) const { return frames[batch][at(slot)]; }
  void set(const PointSet& set, const BlockState& state, int group, int first) {
    const auto nodes = set.nodes(group);
    for (int batch = 0; batch < kBatches; ++batch)
      for (int a = first; a < static_cast<int>(nodes.size()); ++a)
        frames[batch][at(a)].set(set.dofs.kind(nodes[at(a)]), set.shape_of_slot(set.slot_begin[at(group)] + a), false,
                                 batch, broadcast(Mat3d::identity() + turn_of(state, nodes[at(a)])));
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

/// The unit motion of one degree of freedom of slot b after another gives dP and dY, and these the forces on slots a ≥
/// b of the group, which go into blocks of that pair of nodes alone.
/// All that it calls is inlined: matrices of lanes that are passed by memory take as long as what is done with them.
template <PointKind Kind>
[[gnu::flatten]] void PointExecutor::assemble_slot(const BlockState& state, int group, int b,
                                                   const GroupOfFrames& frames, Entries entries,
                                                   BlockMatrix& matrix_out) const {
  constexpr bool kBlend = Kind.stabilization != Stabilization::none;
  const auto nodes = set_.nodes(group);
  const int n = static_cast<int>(nodes.size()), first_slot = set_.slot_begin[at(group)];
  const bool upper = matrix_out.fills_upper();
  const int columns = set_.dofs.size(nodes[at(b)]), end = entries == Entries::all ? n : b + 1;
  const std::uint32_t* pair = pairs_.data() + pair_begin_[at(first_slot + b)];
  for (int a = b, k = 0; a < end; ++a)
    if (together(first_slot + a, first_slot + b))
      prefetch_to_add(matrix_out.at_place(pair[k++]), set_.dofs.size(nodes[at(a)]) * columns);
  LaneMatrix dP[kBatches][kMostDofs], dY[kBatches][kBlend ? kMostDofs : 1];
  for (int batch = 0; batch < kBatches; ++batch) {
    const auto m = material<Kind>(set_, group, batch, state, targets_);
    const PointMotion<Lanes> x = kept_motion<Kind.stabilization>(kept_of(state, group), batch);
    const TangentStress<Lanes> stress = kept_stress<Kind.stabilization>(kept_of(state, group), batch);
    for (int k = 0; k < columns; ++k) {
      const auto d = point_stress_differential<Kind.stabilization>(x, stress, m, state.tangent,
                                                                   unit_motion<kBlend>(frames.of(batch, b), k));
      dP[batch][k].set(d.dP * m.volume);
      if constexpr (kBlend) dY[batch][k].set(d.dY * m.volume);
    }
  }
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

template <PointKind Kind>
void PointExecutor::assemble_group(const BlockState& state, int group, Entries entries, BlockMatrix& matrix_out) const {
  GroupOfFrames frames;
  frames.set(set_, state, group, 0);
  const int n = static_cast<int>(set_.nodes(group).size());
  for (int b = 0; b < n; ++b) assemble_slot<Kind>(state, group, b, frames, entries, matrix_out);
}

/// Fills all blocks of which a node is the first.
void PointExecutor::assemble_node(const BlockState& state, int node, Entries entries, BlockMatrix& matrix_out) const {
  GroupOfFrames frames;
  for (int k = set_.node_slot_begin[at(node)]; k < set_.node_slot_begin[at(node + 1)]; ++k) {
    const int slot = set_.node_slot[at(k)], group = group_of_slot_[at(slot)], b = slot - set_.slot_begin[at(group)];
    if (frames_.lanes().count(group) > 0) continue;
    frames.set(set_, state, group, b);
    with_kind(rule_of(group),
              [&]<PointKind Kind>() { assemble_slot<Kind>(state, group, b, frames, entries, matrix_out); });
  }
}

/// Lane by lane: each has blocks of its own. All frames of the group are of one kind.
template <PointKind Kind, FrameKind Frame>
[[gnu::flatten]] void PointExecutor::assemble_lanes(const BlockState& state, int group, Entries entries,
                                                    BlockMatrix& matrix_out) const {
  constexpr bool kBlend = Kind.stabilization != Stabilization::none;
  constexpr int kDofs = dof_count(Frame);
  const LaneFrames& lanes = frames_.lanes();
  const int n = lanes.count(group);
  const std::uint16_t* starts = lanes.starts(group);
  const bool upper = matrix_out.fills_upper();
  std::array<PointFrame, LaneFrames::kMostFrames> frames;
  for (int batch = 0; batch < kBatches; ++batch) {
    const auto m = material<Kind>(set_, group, batch, state, targets_);
    const PointMotion<Lanes> x = kept_motion<Kind.stabilization>(kept_of(state, group), batch);
    const TangentStress<Lanes> stress = kept_stress<Kind.stabilization>(kept_of(state, group), batch);
    for (int a = 0; a < n; ++a) {
      Lanes D[9];
      const std::uint16_t* own = starts + a * kGroupSize + batch * kBatchWidth;
      gather_rows([&](int lane) { return &turn_of(state, lanes.node_at(group, own[lane]))(0, 0); }, D);
      frames[at(a)].set(Frame, lanes.shape(group) + a * lanes.shape_rows(group) * kGroupSize, lanes.carries(group),
                        batch, Mat3<Lanes>::identity() + matrix_of(D));
    }
    const std::uint32_t* pair = pairs_.data() + pair_begin_[at(set_.slot_begin[at(group)])] + batch * kBatchWidth;
    const std::uint32_t* end = pair + n * (n + 1) / 2 * kGroupSize;
    for (int b = 0; b < n; ++b) {
      LaneMatrix dP[kDofs], dY[kBlend ? kDofs : 1];
      for (int k = 0; k < kDofs; ++k) {
        const auto d = point_stress_differential<Kind.stabilization>(x, stress, m, state.tangent,
                                                                     unit_motion<kBlend>(frames[at(b)], k));
        dP[k].set(d.dP * m.volume);
        if constexpr (kBlend) dY[k].set(d.dY * m.volume);
      }
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

template <PointKind Kind>
void PointExecutor::assemble_one(const BlockState& state, int group, Entries entries, BlockMatrix& matrix_out) const {
  const LaneFrames& lanes = frames_.lanes();
  if (!lanes.has_blocks(group)) return assemble_group<Kind>(state, group, entries, matrix_out);
  if (lanes.kind(group) == FrameKind::rigid)
    assemble_lanes<Kind, FrameKind::rigid>(state, group, entries, matrix_out);
  else
    assemble_lanes<Kind, FrameKind::affine>(state, group, entries, matrix_out);
}

/// Groups of one colour, or patches of one, at the same time; nodes, where colours have few groups.
void PointExecutor::assemble(const BlockState& state, BlockMatrix& matrix_out, Entries entries) {
  const LaneFrames& lanes = frames_.lanes();
  if (pattern_ != matrix_out.pattern()) find_pairs(matrix_out);
  const auto assemble_groups = [&](std::span<const int> groups) {
    for (const int group : groups)
      with_kind(rule_of(group), [&]<PointKind Kind>() { assemble_one<Kind>(state, group, entries, matrix_out); });
  };
  const Coloring& shared = frames_.shared_colors();
  if (!group_of_slot_.empty())
    pool_.for_ranges(set_.node_count(), 1, [&](int node, int) { assemble_node(state, node, entries, matrix_out); });
  for (std::size_t c = 0; group_of_slot_.empty() && c + 1 < shared.begin.size(); ++c) {
    const std::span<const int> groups =
        std::span(shared.item).subspan(at(shared.begin[c]), at(shared.begin[c + 1] - shared.begin[c]));
    pool_.for_ranges(static_cast<int>(groups.size()), 8,
                     [&](int begin, int end) { assemble_groups(groups.subspan(at(begin), at(end - begin))); });
  }
  const Coloring& patches = lanes.colors();
  for (std::size_t c = 0; c + 1 < patches.begin.size(); ++c)
    pool_.for_chunks(patches.begin[c + 1] - patches.begin[c],
                     [&](int i) { assemble_groups(lanes.groups(patches.item[at(patches.begin[c] + i)])); });
}

}  // namespace fascia
