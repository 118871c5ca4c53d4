#include "core/structure/edit.hpp"

#include "core/base/errors.hpp"
#include "core/physics/solid_law.hpp"

#include <algorithm>
#include <string>
#include <unordered_map>
#include <utility>

namespace fascia {

namespace {

/// Where points of a set are: group · 8 + lane, by their running number; −1 of those that left.
std::vector<int> lanes_of(const PointSet& set) {
  std::vector<int> lanes(at(set.point_count), -1);
  for (std::size_t lane = 0; lane < set.lane_point.size(); ++lane)
    if (set.lane_point[lane] >= 0) lanes[at(set.lane_point[lane])] = static_cast<int>(lane);
  return lanes;
}

bool has_left(const ElementBlock& block, int element) {
  double volume = 0;
  for (int q = 0; q < block.points; ++q) volume += block.volume_of(element / kElementLanes, q)[element % kElementLanes];
  return volume == 0;
}

bool has_left(const ShellBlock& shell, int triangle) {
  const double* rows = shell.constants_of(triangle / kElementLanes) + triangle % kElementLanes;
  return rows[ShellBlock::kMembrane * kElementLanes] == 0;
}

template <class Block>
void check_cells(const std::vector<LostCells>& lost, const std::vector<Block>& blocks, const char* cell) {
  for (const LostCells& l : lost) {
    if (l.block < 0 || at(l.block) >= blocks.size())
      throw InputError(std::string("an edit takes ") + cell + "s of block " + std::to_string(l.block) +
                       "; the model has " + std::to_string(blocks.size()));
    const Block& block = blocks[at(l.block)];
    if (block.averaged)
      throw InputError("an edit takes elements whose volumes are averaged about nodes; these cannot leave");
    std::vector<int> sorted = l.cells;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t k = 0; k < sorted.size(); ++k)
      if (sorted[k] < 0 || sorted[k] >= block.count || has_left(block, sorted[k]) ||
          (k > 0 && sorted[k] == sorted[k - 1]))
        throw InputError(std::string("an edit takes ") + cell + " " + std::to_string(sorted[k]) +
                         ", which is not there or has left");
  }
}

void check(const Edit& edit, const Model& model) {
  const PointSet& set = model.points;
  std::vector<int> lanes = lanes_of(set);
  for (const int point : edit.points) {
    if (point < 0 || point >= set.point_count || lanes[at(point)] < 0)
      throw InputError("an edit takes point " + std::to_string(point) + ", which is not there or has left");
    lanes[at(point)] = -1;
  }
  check_cells(edit.elements, set.blocks, "element");
  check_cells(edit.triangles, set.shells, "triangle");
  std::unordered_map<int, double> left;
  for (const LostInertia& l : edit.inertia) {
    if (l.node < 0 || l.node >= model.node_count())
      throw InputError("an edit takes inertia of node " + std::to_string(l.node) + "; the model has " +
                       std::to_string(model.node_count()));
    double& mass = left.try_emplace(l.node, model.inertia[at(l.node)].mass).first->second;
    mass -= l.inertia.mass;
    if (!(mass >= 0))
      throw InputError("an edit leaves node " + std::to_string(l.node) + " a mass of " + std::to_string(mass) +
                       " kg; it must not be below 0");
  }
  if (!edit.added.empty() && !set.memory.empty())
    throw InputError(
        "an edit adds points to a model that remembers stresses or makes them by itself, whose lanes would not fit; "
        "add none");
  const int nodes = model.node_count() + static_cast<int>(edit.nodes.size());
  for (const AddedPoints& added : edit.added) {
    if (added.nodes.empty() || added.nodes.size() > at(kMaxSlots) || added.points.empty() || !(added.length > 0))
      throw InputError("an edit adds points without nodes, with more than " + std::to_string(kMaxSlots) +
                       ", or without a length");
    std::vector<int> sorted = added.nodes;
    std::sort(sorted.begin(), sorted.end());
    if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
      throw InputError("an edit adds points that name node " + std::to_string(*twice) + " twice; name it once");
    for (const int node : added.nodes)
      if (node < 0 || node >= nodes)
        throw InputError("an edit adds points to node " + std::to_string(node) + "; the model has " +
                         std::to_string(nodes) + " with those that it adds");
    for (const PointSample& point : added.points) {
      check_own_constants(added.rule.law, point);
      if (StressBeside{point.viscosity, point.active})
        throw InputError("an edit adds a point that remembers stresses or makes them by itself; these cannot join");
      if (point.influences.size() != added.nodes.size() || !(point.volume > 0))
        throw InputError("an edit adds a point with " + std::to_string(point.influences.size()) + " influences of " +
                         std::to_string(added.nodes.size()) + " nodes, or without volume");
    }
  }
}

/// Nothing of a dead lane depends on its nodes: F stays I.
void take_points(const std::vector<int>& points, PointSet& set) {
  const std::vector<int> lanes = lanes_of(set);
  for (const int point : points) {
    const auto group = at(lanes[at(point)] / kGroupSize), lane = at(lanes[at(point)] % kGroupSize);
    set.lane_point[group * kGroupSize + lane] = -1;
    set.material[group * 6 * kGroupSize + kVolume * kGroupSize + lane] = 0;
    const auto begin = at(set.slot_begin[group]), end = at(set.slot_begin[group + 1]);
    for (std::size_t row = begin * 13; row < end * 13; ++row) set.shape[row * kGroupSize + lane] = 0;
  }
}

void take_elements(const LostCells& lost, ElementBlock& block) {
  for (const int e : lost.cells) {
    const auto batch = at(e / kElementLanes), lane = at(e % kElementLanes);
    const auto clear = [&](AlignedVector<double>& values, std::size_t rows) {
      for (std::size_t row = batch * rows; row < (batch + 1) * rows; ++row) values[row * kElementLanes + lane] = 0;
    };
    clear(block.volume, at(block.points));
    clear(block.gradient, at(block.points * block.nodes * 3));
    clear(block.material, at(block.material_rows()));
  }
}

/// A triangle that left repeats one that did not, without its stiffness, as unused lanes do.
void take_triangles(const LostCells& lost, ShellBlock& shell) {
  const auto clear = [&](int t) {
    for (int row = ShellBlock::kMembrane; row < ShellBlock::kRows; ++row)
      shell.constants[at((t / kElementLanes * ShellBlock::kRows + row) * kElementLanes + t % kElementLanes)] = 0;
  };
  for (const int t : lost.cells) clear(t);
  int live = 0;
  while (live < shell.count && has_left(shell, live)) ++live;
  if (live == shell.count) return;
  for (const int t : lost.cells) {
    const auto copy = [&](auto& values, int rows, int row) {
      values[at((t / kElementLanes * rows + row) * kElementLanes + t % kElementLanes)] =
          values[at((live / kElementLanes * rows + row) * kElementLanes + live % kElementLanes)];
    };
    for (int a = 0; a < 3; ++a) copy(shell.node, 3, a);
    for (int row = 0; row < ShellBlock::kMembrane; ++row) copy(shell.constants, ShellBlock::kRows, row);
  }
}

}  // namespace

void apply(const Edit& edit, Model& model) {
  check(edit, model);
  PointSet& set = model.points;
  take_points(edit.points, set);
  for (const LostCells& lost : edit.elements) take_elements(lost, set.blocks[at(lost.block)]);
  for (const LostCells& lost : edit.triangles) take_triangles(lost, set.shells[at(lost.block)]);
  for (const LostInertia& lost : edit.inertia) {
    FrameInertia gone = lost.inertia;
    gone *= -1;
    model.inertia[at(lost.node)] += gone;
  }
  for (const AddedNode& node : edit.nodes) {
    model.rest_position.push_back(node.X);
    model.rest_orientation.push_back(node.orientation);
    model.frame_kind.push_back(node.kind);
    model.inertia.push_back(node.inertia);
    if (!model.mass_damping.empty()) model.mass_damping.emplace_back();
  }
  PointSetBuilder builder(std::move(set));
  for (std::size_t k = 0; k < edit.nodes.size(); ++k)  // a part of its own until points hang it to others
    builder.join({model.node_count() - static_cast<int>(edit.nodes.size() - k)}, 1);
  for (const AddedPoints& added : edit.added) builder.add_points(added.nodes, added.points, added.length, added.rule);
  set = std::move(builder).finish(model.frame_kind);
}

}  // namespace fascia
