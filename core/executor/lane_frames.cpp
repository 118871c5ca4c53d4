#include "core/executor/lane_frames.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

namespace fascia {

namespace {

/// Groups of a patch: few enough that threads share small bodies too.
int groups_of_patch(int groups) { return std::clamp(groups / 16, 4, 16); }

/// A frame of one's own costs as much as this many that all lanes share: what lanes read and add is turned about.
constexpr int kCost = 2;

/// r of a lane of a slot; where the weight has no gradient none is needed.
Vec3d place_in_frame(const double* shape) {
  Vec3d r;
  double gg = 0;
  for (int j = 0; j < 3; ++j) {
    const double g = shape[(1 + j) * kGroupSize];
    gg += g * g;
    for (int i = 0; i < 3; ++i) r[i] += (shape[(4 + 3 * i + j) * kGroupSize] - (i == j ? shape[0] : 0)) * g;
  }
  return gg >= std::numeric_limits<double>::min() ? r * (1 / gg) : Vec3d{};
}

}  // namespace

LaneFrames::LaneFrames(const PointSet& set) : group_(at(set.group_count())) {
  std::vector<int> groups, nodes, both;
  const auto close = [&] {
    if (!groups.empty()) add_patch(set, groups, nodes);
    groups.clear();
    nodes.clear();
  };
  for (int group = 0; group < set.group_count(); ++group) group_[at(group)].count = count_of(set, group);
  const auto by_lanes = std::count_if(group_.begin(), group_.end(), [](const Group& g) { return g.count > 0; });
  const int most = groups_of_patch(static_cast<int>(by_lanes));
  for (int group = 0; group < set.group_count(); ++group) {
    if (group_[at(group)].count == 0) continue;
    std::vector<int> own(set.nodes(group).begin(), set.nodes(group).end());
    std::sort(own.begin(), own.end());
    both.clear();
    std::set_union(nodes.begin(), nodes.end(), own.begin(), own.end(), std::back_inserter(both));
    if (groups.size() == at(most) || both.size() > at(kPatchNodes)) {
      close();
      both = own;
    }
    groups.push_back(group);
    nodes = both;
  }
  close();
  colors_ = color_items(patch_count(), set.node_count(), [&](int patch) { return this->nodes(patch); });
  find_new_nodes(set.node_count());
}

void LaneFrames::find_new_nodes(int node_count) {
  std::vector<int> first(at(node_count), -1);  // patch that has a node first
  for (const int patch : colors_.item)
    for (const int node : nodes(patch))
      if (first[at(node)] < 0) first[at(node)] = patch;
  for (int patch = 0; patch < patch_count(); ++patch) {
    for (const int node : nodes(patch))
      if (first[at(node)] == patch) new_node_.push_back(node);
    new_node_begin_.push_back(static_cast<int>(new_node_.size()));
  }
  for (int node = 0; node < node_count; ++node)
    if (first[at(node)] < 0) nodes_of_no_patch_.push_back(node);
}

/// Tethers are not of these: their forces are read by groups.
int LaneFrames::count_of(const PointSet& set, int group) {
  if (set.rule[at(group)].rule.law == Law::tether) return 0;
  std::array<int, kGroupSize> frames{};
  for (int slot = set.slot_begin[at(group)]; slot < set.slot_begin[at(group + 1)]; ++slot)
    for (int lane = 0; lane < kGroupSize; ++lane)
      frames[at(lane)] += set.slot_lanes[at(slot)] >> static_cast<unsigned>(lane) & 1U;
  const int most = *std::max_element(frames.begin(), frames.end());
  const int all = static_cast<int>(set.nodes(group).size());
  return most <= kMostFrames && kCost * most <= all ? most : 0;
}

/// What is left of B is rounding, beside the largest frame of the group.
bool LaneFrames::carries(const PointSet& set, int group) {
  constexpr double kRounding = 1e-14;
  double left = 0, size = 0;
  for (int slot = set.slot_begin[at(group)]; slot < set.slot_begin[at(group + 1)]; ++slot) {
    for (int lane = 0; lane < kGroupSize; ++lane) {
      const double* shape = set.shape_of_slot(slot) + lane;
      const Vec3d r = place_in_frame(shape);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const double B = shape[(4 + 3 * i + j) * kGroupSize];
          left = std::max(left, std::abs(B - (i == j ? shape[0] : 0) - r[i] * shape[(1 + j) * kGroupSize]));
          size = std::max(size, std::abs(B));
        }
    }
  }
  return left <= kRounding * size;
}

void LaneFrames::add_patch(const PointSet& set, std::span<const int> groups, std::vector<int> nodes) {
  for (const int group : groups) {
    group_[at(group)].patch = patch_count();
    add_group(set, group, nodes);
  }
  patch_group_.insert(patch_group_.end(), groups.begin(), groups.end());
  patch_group_begin_.push_back(static_cast<int>(patch_group_.size()));
  patch_node_.insert(patch_node_.end(), nodes.begin(), nodes.end());
  patch_node_begin_.push_back(static_cast<int>(patch_node_.size()));
}

void LaneFrames::add_group(const PointSet& set, int group, std::span<const int> nodes) {
  Group& g = group_[at(group)];
  const std::span<const int> own = set.nodes(group);
  g.begin = start_.size() / kGroupSize;
  g.kind = set.dofs.kind(own[0]);
  g.has_blocks = g.kind != FrameKind::vertex &&
                 std::all_of(own.begin(), own.end(), [&](int node) { return set.dofs.kind(node) == g.kind; });
  start_.resize(start_.size() + at(g.count) * kGroupSize);
  g.rows = carries(set, group) ? kCarriedRows : kRows;
  g.shape = shape_.size();
  shape_.resize(shape_.size() + at(g.count * g.rows) * kGroupSize);
  std::uint16_t* start = start_.data() + g.begin * kGroupSize;
  double* shape = shape_.data() + g.shape;
  std::vector<std::uint16_t> start_of_slot;
  start_of_slot.reserve(own.size());
  for (const int node : own)
    start_of_slot.push_back(
        static_cast<std::uint16_t>((std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin()) * kNumbers));
  for (int lane = 0; lane < kGroupSize; ++lane) {
    int k = 0;
    std::uint16_t last = start_of_slot[0];  // a dead lane follows some frame of the group, with nothing
    for (std::size_t s = 0; s < own.size(); ++s) {
      const int slot = set.slot_begin[at(group)] + static_cast<int>(s);
      if ((set.slot_lanes[at(slot)] >> static_cast<unsigned>(lane) & 1U) == 0) continue;
      last = start_of_slot[s];
      start[k * kGroupSize + lane] = last;
      double* row = shape + k * g.rows * kGroupSize + lane;
      const double* from = set.shape_of_slot(slot) + lane;
      for (int r = 0; r < 4; ++r) row[r * kGroupSize] = from[r * kGroupSize];
      const Vec3d about = place_in_frame(from);
      for (int r = 4; r < g.rows; ++r)
        row[r * kGroupSize] = g.rows == kCarriedRows ? about[r - 4] : from[r * kGroupSize];
      ++k;
    }
    for (; k < g.count; ++k) start[k * kGroupSize + lane] = last;
  }
}

}  // namespace fascia
