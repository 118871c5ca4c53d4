#pragma once

#include "core/base/coloring.hpp"
#include "core/base/index.hpp"
#include "core/structure/point_set.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace fascia {

/// Groups whose points follow few of the group's frames each, as scattered points do: the frames of a group of eight
/// are 20 to 30 there, those of one point 4. Each lane has its own frames here. Groups that follow one another make
/// patches, whose frames are numbered within the patch, so that what a loop over a patch reads and adds stays near.
class LaneFrames {
 public:
  static constexpr int kPatchNodes = 256;  ///< at most
  static constexpr int kMostFrames = 16;   ///< of a point in such a group
  static constexpr int kNumbers = 12;      ///< of a frame that a loop over a patch reads or adds to

  explicit LaneFrames(const PointSet& set);

  /// Most frames that a point of a group follows; 0 where the group is not one of these.
  int count(int group) const { return group_[at(group)].count; }
  /// All frames of a group are rigid, or all are affine: each lane's blocks of a matrix are alike.
  bool has_blocks(int group) const { return group_[at(group)].has_blocks; }
  /// Kind of the group's frames, where it has blocks.
  FrameKind kind(int group) const { return group_[at(group)].kind; }
  /// Tells (count × 8) where the numbers of each lane's frames start among those of the patch, in the group's order;
  /// the last again where a lane has fewer.
  const std::uint16_t* starts(int group) const { return start_.data() + group_[at(group)].begin * kGroupSize; }
  /// The node of a group's patch whose numbers start there.
  int node_at(int group, std::uint16_t start) const { return nodes(patch_of(group))[start / kNumbers]; }
  /// Each frame carries what is about it as a rigid body does, with a weight: ψ = w r, so that B = w I + r gᵀ with the
  /// point's place r in the frame. Weights of moving least squares are not so.
  bool carries(int group) const { return group_[at(group)].rows == kCarriedRows; }
  /// (count × 7 × 8) w, g (3), r (3) where frames carry; else (count × 13 × 8) as PointSet::shape.
  const double* shape(int group) const { return shape_.data() + group_[at(group)].shape; }
  int shape_rows(int group) const { return group_[at(group)].rows; }

  /// Patches of one colour share no node.
  const Coloring& colors() const { return colors_; }
  int patch_count() const { return static_cast<int>(patch_group_begin_.size()) - 1; }
  std::span<const int> groups(int patch) const { return part(patch_group_, patch_group_begin_, patch); }
  std::span<const int> nodes(int patch) const { return part(patch_node_, patch_node_begin_, patch); }
  /// Its nodes that no patch of an earlier colour has; and nodes of no patch.
  std::span<const int> new_nodes(int patch) const { return part(new_node_, new_node_begin_, patch); }
  std::span<const int> nodes_of_no_patch() const { return nodes_of_no_patch_; }
  int patch_of(int group) const { return group_[at(group)].patch; }
  /// Number of a patch's first node among those of all patches.
  int first_node(int patch) const { return patch_node_begin_[at(patch)]; }
  int node_total() const { return patch_node_begin_.back(); }

 private:
  struct Group {
    int count = 0;
    std::size_t begin = 0;  ///< among frames of lanes, eight at a time
    std::size_t shape = 0;
    int rows = 0;  ///< of the shape of a frame
    int patch = -1;
    FrameKind kind = FrameKind::vertex;
    bool has_blocks = false;
  };
  static std::span<const int> part(const std::vector<int>& all, const std::vector<int>& begin, int patch) {
    return std::span(all).subspan(at(begin[at(patch)]), at(begin[at(patch + 1)] - begin[at(patch)]));
  }
  static constexpr int kCarriedRows = 7, kRows = 13;
  static int count_of(const PointSet& set, int group);
  static bool carries(const PointSet& set, int group);
  void add_patch(const PointSet& set, std::span<const int> groups, std::vector<int> nodes);
  void add_group(const PointSet& set, int group, std::span<const int> nodes);
  void find_new_nodes(int node_count);

  std::vector<Group> group_;
  Coloring colors_;
  std::vector<std::uint16_t> start_;
  AlignedVector<double> shape_;
  std::vector<int> patch_group_, patch_group_begin_{0};
  std::vector<int> patch_node_, patch_node_begin_{0};
  std::vector<int> new_node_, new_node_begin_{0}, nodes_of_no_patch_;
};

}  // namespace fascia
