#pragma once

#include "core/base/thread_pool.hpp"
#include "core/executor/block_executor.hpp"
#include "core/executor/lane_frames.hpp"
#include "core/math/batch.hpp"

#include <array>
#include <span>
#include <vector>

namespace fascia {

struct GroupStress;

/// Adds the twelve numbers that a sum of a frame has.
void add_numbers(const double* s, NodeSum& sum);

/// Moves points by their frames, and sums what they do to these, in two layouts: lanes of a group share its frames, and
/// sums are the group's; or each lane has few of its own, and sums are those of a patch (LaneFrames). Frames have
/// twelve numbers: of a motion u and D, of a sum Σ v P g (3) and Σ v (P Bᵀ + w Y) (9). Templates of it are in
/// point_kernels.hpp.
class PointFrames {
 public:
  static constexpr int kNumbers = LaneFrames::kNumbers;
  using Rows = const double*;  ///< (frames × 12) by node, or by frame of a patch

  PointFrames(const PointSet& set, ThreadPool& pool);

  const LaneFrames& lanes() const { return lanes_; }
  /// Groups that share frames, by colour: those of one share no frame.
  const Coloring& shared_colors() const { return shared_colors_; }

  /// Displacements and rotations − I of the nodes that move points. @param room  keeps them
  Rows rows_of(const BlockState& state, AlignedVector<double>& room) const;

  /// Calls act(group, rows) for each group, with the rows of these motions that motion() takes.
  /// @param sums  put() is called for every group
  template <std::size_t N, class Act>
  void for_each_group(const std::array<Rows, N>& motions, bool sums, const Act& act);

  /// Motion of a batch of a group's points. @tparam Blend  with blended rotations
  template <bool Blend>
  PointMotion<Lanes> motion(int group, int batch, Rows rows) const;

  /// Sums what a group's points do to its frames.
  template <bool Blend>
  void put(int group, const GroupStress& stress);

  /// Adds what all groups have put for a node. @param tethers  of tethers alone
  void add_sums(int node, bool tethers, NodeSum& sum) const;

 private:
  static constexpr int kGrain = 32;
  double* sums_of(int place) { return sums_.data() + at(place) * kNumbers; }

  const PointSet& set_;
  ThreadPool& pool_;
  LaneFrames lanes_;
  std::vector<int> shared_;  ///< groups whose lanes share frames
  Coloring shared_colors_;
  std::vector<int> group_place_;  ///< of sums: the first one of a group, or of its patch
  std::vector<int> patch_place_;
  std::vector<int> node_place_begin_, node_place_;  ///< (nodes + 1), places of each node, ascending
  std::vector<int> moving_;                         ///< nodes that have places
  std::vector<char> place_is_tether_;               ///< empty where there are none
  AlignedVector<double> sums_;                      ///< (places × 12)
};

}  // namespace fascia
