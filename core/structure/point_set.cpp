#include "core/structure/point_set.hpp"

#include "core/base/coloring.hpp"
#include "core/base/errors.hpp"
#include "core/base/incidence.hpp"
#include "core/base/index.hpp"
#include "core/physics/solid_law.hpp"
#include "core/structure/blocks.hpp"
#include "core/structure/parts.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>
#include <utility>

namespace fascia {

PointSetBuilder::PointSetBuilder(PointSet&& set)
    : set_(std::move(set)), group_length_(std::move(set_.group_length)), joints_(std::move(set_.joints)) {
  take_body();
}

void PointSetBuilder::add_points(std::span<const int> nodes, std::span<const PointSample> points, double length,
                                 const PointRule& rule) {
  if (std::adjacent_find(nodes.begin(), nodes.end(), std::greater_equal<>()) != nodes.end())
    return add_in_order(nodes, points, length, rule);
  for (std::size_t first = 0; first < points.size(); first += kGroupSize)
    add_group(nodes, points.subspan(first, std::min<std::size_t>(kGroupSize, points.size() - first)), length, rule);
}

void PointSetBuilder::reserve(std::size_t groups, std::size_t slots) {
  const auto more = [](auto& values, std::size_t count) {  // what grows by little doubles by itself
    if (count > values.size()) values.reserve(values.size() + count);
  };
  more(set_.shape, slots * 13 * kGroupSize);
  more(set_.slot_node, slots);
  more(set_.material, groups * 6 * kGroupSize);
  more(set_.lane_point, groups * kGroupSize);
  more(set_.slot_begin, groups);
  more(set_.rule, groups);
  more(group_length_, groups);
}

void PointSetBuilder::add_in_order(std::span<const int> nodes, std::span<const PointSample> points, double length,
                                   const PointRule& rule) {
  std::vector<std::size_t> order(nodes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return nodes[a] < nodes[b]; });
  std::vector<int> sorted;
  sorted.reserve(nodes.size());
  for (const std::size_t k : order) {
    if (!sorted.empty() && sorted.back() == nodes[k])
      throw InputError("points name node " + std::to_string(nodes[k]) + " twice; each of their nodes once");
    sorted.push_back(nodes[k]);
  }
  std::vector<PointSample> moved(points.begin(), points.end());
  for (std::size_t p = 0; p < points.size(); ++p)
    for (std::size_t k = 0; k < order.size(); ++k) moved[p].influences[k] = points[p].influences[order[k]];
  add_points(sorted, moved, length, rule);
}

void PointSetBuilder::add_group(std::span<const int> nodes, std::span<const PointSample> points, double length,
                                const PointRule& rule) {
  const std::size_t first_shape = set_.shape.size(), first_material = set_.material.size();
  set_.shape.resize(first_shape + nodes.size() * 13 * kGroupSize);
  set_.material.resize(first_material + 6 * kGroupSize);
  for (std::size_t lane = 0; lane < kGroupSize; ++lane) {
    const bool used = lane < points.size();
    const PointSample& p = points[std::min(lane, points.size() - 1)];
    double squared_gradient = 0;
    for (std::size_t slot = 0; slot < nodes.size(); ++slot) {
      const Influence& influence = p.influences[slot];
      double* row = set_.shape.data() + first_shape + slot * 13 * kGroupSize + lane;
      row[0] = influence.w;
      for (std::size_t k = 0; k < 3; ++k) row[(1 + k) * kGroupSize] = influence.g[static_cast<int>(k)];
      for (std::size_t k = 0; k < 9; ++k)
        row[(4 + k) * kGroupSize] = influence.B(static_cast<int>(k / 3), static_cast<int>(k % 3));
      squared_gradient += squared_norm(influence.g) + contract(influence.B, influence.B) / (length * length);
    }
    double* material = set_.material.data() + first_material + lane;
    material[kVolume * kGroupSize] = used ? p.volume : 0.0;
    material[kLambda * kGroupSize] = p.lambda;
    material[kMu * kGroupSize] = p.mu;
    material[kStabilization * kGroupSize] = p.stabilization;
    material[kStiffnessDamping * kGroupSize] = p.stiffness_damping;
    material[kGradientNorm * kGroupSize] = std::sqrt(squared_gradient);
    set_.damped = set_.damped || p.stiffness_damping > 0;
    set_.lane_point.push_back(used ? set_.point_count++ : -1);
  }
  add_rule(points, length, rule);
  add_beside(points, rule);
  set_.slot_node.insert(set_.slot_node.end(), nodes.begin(), nodes.end());
  set_.slot_begin.push_back(set_.slot_count());
}

void PointSetBuilder::add_rule(std::span<const PointSample> points, double length, PointRule rule) {
  if (std::none_of(points.begin(), points.end(), [](const PointSample& p) { return p.stabilization > 0; }))
    rule.stabilization = Stabilization::none;
  GroupRule group{rule};
  if (is_thin(rule.law)) {
    const std::size_t first = set_.axes.size();
    group.axes = static_cast<int>(first / (9 * kGroupSize));
    set_.axes.resize(first + 9 * kGroupSize);
    for (std::size_t lane = 0; lane < kGroupSize; ++lane)
      for (std::size_t k = 0; k < 9; ++k)
        set_.axes[first + k * kGroupSize + lane] =
            points[std::min(lane, points.size() - 1)].axes(static_cast<int>(k / 3), static_cast<int>(k % 3));
  }
  add_own_constants(points, group);
  set_.rule.push_back(group);
  group_length_.push_back(length);
}

/// A point that lacks them has zeros.
void PointSetBuilder::add_own_constants(std::span<const PointSample> points, GroupRule& group) {
  const auto rows = at(own_constant_count(group.rule.law));
  for (const PointSample& p : points) check_own_constants(group.rule.law, p);
  if (rows == 0) return;
  group.own = static_cast<int>(set_.own.size() / kGroupSize);
  for (std::size_t k = 0; k < rows; ++k) {
    for (std::size_t lane = 0; lane < kGroupSize; ++lane) {
      const PointSample& p = points[std::min(lane, points.size() - 1)];
      set_.own.push_back(k < p.own.size() ? p.own[k] : 0.0);
    }
  }
}

void PointSetBuilder::add_beside(std::span<const PointSample> points, const PointRule& rule) {
  const std::size_t end = set_.rule.size() * kGroupSize, first = end - kGroupSize;
  for (std::size_t lane = 0; lane < points.size(); ++lane) {
    const PointSample& p = points[lane];
    const StressBeside beside{p.viscosity, p.active};
    if (!beside) continue;
    if (p.viscosity) check_viscosity(rule.law, *p.viscosity, p.stiffness_damping);
    set_.beside.resize(end);
    set_.source.resize(end, PointSample::kNoSource);
    set_.beside[first + lane] = beside;
    set_.source[first + lane] = p.source;
  }
}

void PointSetBuilder::add_shell(ShellBlock shell) {
  set_.damped = set_.damped || shell.damped;
  set_.shells.push_back(std::move(shell));
}

void PointSetBuilder::add_spring(const Spring& spring) { set_.springs.push_back(spring); }

void PointSetBuilder::add_dependent(DependentNode node) { set_.dependents.push_back(std::move(node)); }

void PointSetBuilder::join(std::vector<int> nodes, double length) { joints_.push_back({std::move(nodes), length}); }

BodyBlocks PointSetBuilder::take_body() {
  const auto since = [](const BodyBlocks::Run& before, std::size_t size) {
    return BodyBlocks::Run{before.end(), static_cast<int>(size) - before.end()};
  };
  taken_ = {since(taken_.groups, static_cast<std::size_t>(set_.group_count())),
            since(taken_.elements, set_.blocks.size()), since(taken_.shells, set_.shells.size())};
  return taken_;
}

void PointSetBuilder::add_user_block(std::shared_ptr<const UserBlock> block) {
  if (!block) throw InputError("a user block is missing; give one");
  set_.user_blocks.push_back(std::move(block));
}

void PointSetBuilder::add_elements(ElementBlock block) {
  set_.damped = set_.damped || block.damped;
  set_.blocks.push_back(std::move(block));
}

namespace {

void transpose_incidence(PointSet& set) {
  const auto for_each_slot = [&](const auto& act) {
    for (int slot = 0; slot < set.slot_count(); ++slot) act(set.slot_node[at(slot)], slot);
  };
  list_by_node(set.node_count(), for_each_slot, set.node_slot_begin, set.node_slot);
}

void find_lanes_of_slots(PointSet& set) {
  constexpr unsigned kAll = (1U << kGroupSize) - 1;
  set.slot_lanes.resize(at(set.slot_count()));
  for (int slot = 0; slot < set.slot_count(); ++slot) {
    const double* row = set.shape_of_slot(slot);
    unsigned lanes = 0;
    for (int r = 0; r < 13 && lanes != kAll; ++r, row += kGroupSize)
      for (int lane = 0; lane < kGroupSize; ++lane) lanes |= row[lane] != 0 ? 1U << static_cast<unsigned>(lane) : 0U;
    set.slot_lanes[at(slot)] = static_cast<std::uint8_t>(lanes);
  }
}

/// In the order in which CpuExecutor has the blocks.
void lay_out_memory(PointSet& set) {
  if (!set.beside.empty()) {
    set.beside.resize(at(set.group_count()) * kGroupSize);
    set.source.resize(set.beside.size(), PointSample::kNoSource);
  }
  set.memory.add_block(set.beside);
  for (const ElementBlock& block : set.blocks) set.memory.add_block(block.beside);
  for (const ShellBlock& shell : set.shells) set.memory.add_block(shell.beside_of_lanes());
  for (std::size_t others = set.user_blocks.size(); others > 0; --others) set.memory.add_block({});
}

void check_user_blocks(const PointSet& set) {
  for (const auto& block : set.user_blocks)
    for (int c = 0; c < block->count(); ++c)
      for (const int node : block->cell(c))
        if (node >= set.node_count())
          throw InputError("cell " + std::to_string(c) + " of a user block names node " + std::to_string(node) +
                           "; the model has " + std::to_string(set.node_count()));
}

/// Puts each dependent node behind those of its hosts that depend on others.
void sort_dependents(PointSet& set) {
  if (set.dependents.empty()) return;
  std::vector<int> index(at(set.node_count()), -1);
  for (std::size_t k = 0; k < set.dependents.size(); ++k) index[at(set.dependents[k].node)] = static_cast<int>(k);
  std::vector<int> sorted, waiting;
  std::vector<std::size_t> next(set.dependents.size(), 0);  // host to look at
  std::vector<char> placed(set.dependents.size(), 0);
  for (std::size_t first = 0; first < set.dependents.size(); ++first) {
    waiting.assign(1, static_cast<int>(first));
    while (!waiting.empty()) {
      const std::size_t k = at(waiting.back());
      const std::vector<int>& hosts = set.dependents[k].hosts;
      if (placed[k] != 0) {
        waiting.pop_back();
      } else if (next[k] < hosts.size()) {
        const int host = index[at(hosts[next[k]++])];
        if (host >= 0) waiting.push_back(host);
      } else {
        placed[k] = 1;
        sorted.push_back(static_cast<int>(k));
      }
    }
  }
  std::vector<DependentNode> dependents;
  dependents.reserve(sorted.size());
  for (const int k : sorted) dependents.push_back(std::move(set.dependents[at(k)]));
  set.dependents = std::move(dependents);
}

}  // namespace

PointSet PointSetBuilder::finish(std::vector<FrameKind> frames) && {
  set_.dofs = DofLayout(std::move(frames));
  set_.memory = {};
  check_user_blocks(set_);
  lay_out_memory(set_);
  transpose_incidence(set_);
  find_lanes_of_slots(set_);
  sort_dependents(set_);
  find_parts(set_, group_length_, joints_);
  Coloring colors = color_items(set_.group_count(), set_.node_count(), [&](int group) { return set_.nodes(group); });
  set_.color_begin = std::move(colors.begin);
  set_.color_group = std::move(colors.item);
  for (ElementBlock& block : set_.blocks) finish_element_block(block, set_.node_count());
  for (ShellBlock& shell : set_.shells) finish_shell_block(shell, set_.node_count());
  set_.group_length = std::move(group_length_);
  set_.joints = std::move(joints_);
  return std::move(set_);
}

double PointGroups::stiffness_of(int group) const {
  if (set.rule[at(group)].rule.law == Law::tether) return 0;
  const double* material = set.material_of_group(group);
  double stiffness = 0;
  for (int lane = 0; lane < kGroupSize; ++lane)
    stiffness = std::max(stiffness, material[kLambda * kGroupSize + lane] + 2 * material[kMu * kGroupSize + lane]);
  return stiffness;
}

double PointGroups::stiffness_sum() const {
  double sum = 0;
  for (int group = 0; group < set.group_count(); ++group) {
    if (set.rule[at(group)].rule.law == Law::tether) continue;
    const double* material = set.material_of_group(group);
    for (int lane = 0; lane < kGroupSize; ++lane) {
      const double g = material[kGradientNorm * kGroupSize + lane];
      sum += material[kVolume * kGroupSize + lane] *
             (material[kLambda * kGroupSize + lane] + 2 * material[kMu * kGroupSize + lane]) * g * g;
    }
  }
  return sum;
}

}  // namespace fascia
