#include "app/bench/traffic.hpp"

#include "core/base/index.hpp"

#include <bit>

namespace fascia::app {
namespace {

constexpr double kDouble = sizeof(double), kIndex = sizeof(int), kLocal = sizeof(std::uint16_t);
constexpr double kRow = kGroupSize * kDouble;  ///< a number of each lane
constexpr double kVector = 3 * kDouble, kMatrix = 9 * kDouble;

double bytes_of(const auto& array) { return static_cast<double>(array.size() * sizeof(array[0])); }

double pairs_of(double nodes) { return nodes * (nodes + 1) / 2; }

/// Rows of material that a group's law needs: volume, λ, μ; γ beside them where something is tied.
double material_rows(const PointRule& rule) { return rule.stabilization == Stabilization::none ? 3 : 4; }

/// Rows that a product reads of what is kept: H (9) and S (6); Dbar (9) and the drilling stress (3).
double kept_rows(Stabilization tie) {
  if (tie == Stabilization::none) return 15;
  return tie == Stabilization::drilling ? 27 : 24;
}

/// Lanes of a group that have a point, as bits.
unsigned used_lanes(const PointSet& set, int group) {
  unsigned lanes = 0;
  for (int lane = 0; lane < kGroupSize; ++lane)
    if (set.lane_point[at(group) * kGroupSize + at(lane)] >= 0) lanes |= 1U << static_cast<unsigned>(lane);
  return lanes;
}

}  // namespace

TrafficCount::TrafficCount(const PointSet& set) : set_(set) {
  for (const FrameKind kind : set.dofs.kinds()) vertices_ += kind == FrameKind::vertex ? 1 : 0;
  count_groups();
  group_constants_ = constants_;
  count_elements();
  count_shells();
  sees_state_again_ = !set.blocks.empty() || !set.shells.empty();
}

/// A group's lanes share frames, of which each has 13 rows; or each lane has some of its own, in patches.
void TrafficCount::count_groups() {
  points_ += set_.point_count;
  constants_ += bytes_of(set_.axes) + bytes_of(set_.own);
  if (set_.group_count() == 0) return;
  const LaneFrames lanes(set_);
  for (int patch = 0; patch < lanes.patch_count(); ++patch)
    constants_ += static_cast<double>(lanes.nodes(patch).size()) * kIndex;
  for (int group = 0; group < set_.group_count(); ++group) {
    const PointRule& rule = set_.rule[at(group)].rule;
    const int begin = set_.slot_begin[at(group)], end = set_.slot_begin[at(group + 1)];
    const unsigned used = used_lanes(set_, group);
    double influences = 0;
    for (int slot = begin; slot < end; ++slot) influences += std::popcount(set_.slot_lanes[at(slot)] & used);
    add_operations_of_points(rule, std::popcount(used), influences, lanes.count(group) > 0 && lanes.carries(group));
    constants_ += material_rows(rule) * kRow;
    kept_ += kept_rows(rule.stabilization) * kRow;
    if (const double own = lanes.count(group); own > 0) {
      constants_ += own * (lanes.shape_rows(group) * kRow + kGroupSize * kLocal);
      pairs_ += pairs_of(own) * kGroupSize * kIndex;
      continue;
    }
    constants_ += (end - begin) * (13 * kRow + kIndex);
    for (int a = begin; a < end; ++a)
      for (int b = begin; b <= a; ++b) pairs_ += (set_.slot_lanes[at(a)] & set_.slot_lanes[at(b)]) != 0 ? kIndex : 0;
  }
}

void TrafficCount::add_operations_of_points(const PointRule& rule, double points, double influences, bool carried) {
  counts_operations_ =
      counts_operations_ && rule.law == Law::st_venant_kirchhoff && rule.stabilization == Stabilization::none;
  const double motion = carried ? 54 : 72, sums = carried ? 54 : 72;
  operations_.forces += points * (45 + 12 + 54 + 9) + influences * (motion + sums);
  operations_.linearization += points * (45 + 12) + influences * (carried ? 54 : 90);
  operations_.product += points * (57 + 12 + 108 + 9) + influences * (motion + sums);
}

void TrafficCount::add_operations(const ElementBlock& block) {
  counts_operations_ =
      counts_operations_ && block.law == Law::st_venant_kirchhoff && !block.averaged && !block.penalised;
  const double points = static_cast<double>(block.count) * block.points;
  operations_.forces += points * (45 + 12 + 54 + 9 + block.nodes * (18 + 18));
  operations_.product += points * (57 + 51 + 12 + 99 + 9 + block.nodes * (36 + 18));
}

std::optional<double> TrafficCount::counted(double operations) const {
  return counts_operations_ && operations > 0 ? std::optional(operations) : std::nullopt;
}

void TrafficCount::count_elements() {
  for (const ElementBlock& block : set_.blocks) {
    add_operations(block);
    const double batches = block.batch_count(), rows = 2 + (block.penalised ? 1 : 0) + block.own_constants;
    points_ += static_cast<double>(block.count) * block.points;
    constants_ += bytes_of(block.gradient) + bytes_of(block.volume) + bytes_of(block.local) +
                  bytes_of(block.patch_node) + batches * rows * kRow;
    pairs_ += batches * pairs_of(block.nodes) * kElementLanes * sizeof(std::uint32_t);
  }
}

/// The last row of a triangle's constants is its damping.
void TrafficCount::count_shells() {
  for (const ShellBlock& shell : set_.shells) {
    counts_operations_ = false;
    points_ += shell.count;
    constants_ += bytes_of(shell.node) + shell.batch_count() * (ShellBlock::kRows - 1) * kRow;
    pairs_ += shell.batch_count() * pairs_of(3) * kElementLanes * sizeof(std::uint32_t);
  }
}

double TrafficCount::turning() const { return (set_.node_count() - vertices_) * kMatrix; }

double TrafficCount::state() const { return set_.node_count() * kVector + turning(); }

Traffic TrafficCount::forces() const {
  return {constants_ + state(), set_.dofs.total() * kDouble, 0, counted(operations_.forces)};
}

Traffic TrafficCount::linearization(const Linearization& lin) const {
  return {group_constants_ + state() + turning(),
          bytes_of(lin.Q) + bytes_of(lin.node_blocks) + bytes_of(lin.u) + bytes_of(lin.D) + bytes_of(lin.kept), 0,
          counted(operations_.linearization)};
}

Traffic TrafficCount::product(const Linearization& lin) const {
  const double vector = set_.dofs.total() * kDouble;
  return {vector + constants_ + kept_ + bytes_of(lin.node_blocks) + turning() + (sees_state_again_ ? state() : 0),
          vector, 0, counted(operations_.product)};
}

Traffic TrafficCount::assembly(const Linearization& lin, const BlockMatrix& matrix) const {
  return {product(lin).read - set_.dofs.total() * kDouble + pairs_,
          static_cast<double>(matrix.value_count()) * kDouble,
          0,
          {}};
}

Traffic assembled_product_traffic(const BlockMatrix& matrix) {
  const DofLayout& dofs = matrix.dofs();
  double entries = 0, blocks = 0;
  for (int row = 0; row < matrix.rows(); ++row)
    for (const int column : matrix.columns(row)) {
      entries += static_cast<double>(dofs.size(row)) * dofs.size(column);
      blocks += !matrix.fills_upper() || column >= row ? 1 : 0;
    }
  const double vector = dofs.total() * kDouble;
  return {static_cast<double>(matrix.value_count()) * kDouble + blocks * kIndex + matrix.rows() * kIndex + vector,
          vector, 0, 2 * entries};
}

Traffic dot_traffic(std::size_t unknowns) {
  const auto n = static_cast<double>(unknowns);
  return {2 * n * kDouble, 0, 0, 2 * n};
}

Traffic axpy_traffic(std::size_t unknowns) {
  const auto n = static_cast<double>(unknowns);
  return {4 * n * kDouble, 2 * n * kDouble, 2 * n * kDouble, 4 * n};
}

}  // namespace fascia::app
