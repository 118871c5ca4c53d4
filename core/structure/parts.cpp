#include "core/structure/parts.hpp"

#include "core/base/disjoint_sets.hpp"
#include "core/base/index.hpp"
#include "core/structure/blocks.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace fascia {

namespace {

/// Calls act(nodes) for what follows hosts, and for what is joined without matter.
template <class Act>
void for_each_bond(const PointSet& set, const std::vector<Joint>& joints, const Act& act) {
  for (const DependentNode& dependent : set.dependents) {
    std::vector<int> nodes = dependent.hosts;
    nodes.push_back(dependent.node);
    act(std::span<const int>(nodes));
  }
  for (const Joint& joint : joints) act(std::span<const int>(joint.nodes));
}

/// Of each node: the stiffest material that moves it, or that moves what is bound to it [Pa].
std::vector<double> node_stiffness(const PointSet& set, const std::vector<Joint>& joints) {
  std::vector<double> stiffness(at(set.node_count()), 0.0);
  for_each_cell(set, [&](std::span<const int> nodes, double s) {
    for (const int node : nodes) stiffness[at(node)] = std::max(stiffness[at(node)], s);
  });
  for (int round = 0; round < 2; ++round)  // what hosts follow may follow hosts
    for_each_bond(set, joints, [&](std::span<const int> nodes) {
      double s = 0;
      for (const int node : nodes) s = std::max(s, stiffness[at(node)]);
      for (const int node : nodes) stiffness[at(node)] = s;
    });
  return stiffness;
}

DisjointSets connect(const PointSet& set, const std::vector<Joint>& joints) {
  DisjointSets sets(set.node_count());
  const auto join = [&](std::span<const int> nodes) {
    for (const int node : nodes) sets.join(node, nodes[0]);
  };
  for_each_cell(set, [&](std::span<const int> nodes, double) { join(nodes); });
  for_each_bond(set, joints, join);
  return sets;
}

/// The same where a tie holds only neighbours of like stiffness together.
DisjointSets connect_alike(const PointSet& set, const std::vector<Joint>& joints,
                           const std::vector<double>& stiffness) {
  DisjointSets sets(set.node_count());
  std::vector<int> sorted;
  for_each_cell(set, [&](std::span<const int> nodes, double) {
    sorted.assign(nodes.begin(), nodes.end());
    std::sort(sorted.begin(), sorted.end(), [&](int a, int b) { return stiffness[at(a)] < stiffness[at(b)]; });
    for (std::size_t k = 1; k < sorted.size(); ++k) {
      const double softer = stiffness[at(sorted[k - 1])];
      if (softer == 0 || stiffness[at(sorted[k])] <= kContrast * softer) sets.join(sorted[k - 1], sorted[k]);
    }
  });
  for_each_bond(set, joints, [&](std::span<const int> nodes) {
    for (const int node : nodes) sets.join(node, nodes[0]);
  });
  return sets;
}

/// Numbers of sets by node, in the order of their first nodes; how many there are.
int number_sets(DisjointSets& sets, std::vector<int>& number) {
  int count = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    const int root = sets.root(static_cast<int>(i));
    number[i] = at(root) == i ? count++ : number[at(root)];
  }
  return count;
}

/// Mean spacing of the frames of each part, weighted with volume [m].
std::vector<double> part_lengths(const PointSet& set, int parts, const std::vector<double>& group_length,
                                 const std::vector<Joint>& joints) {
  std::vector<double> volume(at(parts)), length(at(parts)), of_joints(at(parts)), out;
  const auto weigh = [&](int part, double v, double spacing) {
    volume[at(part)] += v;
    length[at(part)] += v * spacing;
  };
  for (int group = 0; group < set.group_count(); ++group) {
    if (set.rule[at(group)].rule.law == Law::tether) continue;
    for (int lane = 0; lane < kGroupSize; ++lane)
      weigh(set.part_of_group(group), set.material_of_group(group)[kVolume * kGroupSize + lane],
            group_length[at(group)]);
  }
  const auto weigh_cell = [&](int node, double edge) { weigh(set.node_part[at(node)], std::pow(edge, 3), edge); };
  for (const ElementBlock& block : set.blocks)
    block.for_each_element([&](std::span<const int> element) { weigh_cell(element[0], block.length); });
  for (const ShellBlock& shell : set.shells)
    for (int e = 0; e < shell.count; ++e) weigh_cell(shell.element(e)[0], shell.length);
  for (const auto& block : set.user_blocks)
    block->for_each_cell([&](std::span<const int> cell, double) { weigh_cell(cell[0], block->length); });
  for (const Joint& joint : joints) {
    if (joint.nodes.empty()) continue;
    double& largest = of_joints[at(set.node_part[at(joint.nodes[0])])];
    largest = std::max(largest, joint.length);
  }
  std::vector<double> of_wholes(at(parts));  // for parts in which no cell begins
  for (std::size_t p = 0; p < volume.size(); ++p) {
    const double without_matter = of_joints[p] > 0 ? of_joints[p] : 0.0;
    out.push_back(volume[p] > 0 ? length[p] / volume[p] : without_matter);
    double& of_whole = of_wholes[at(set.part_whole[p])];
    of_whole = std::max(of_whole, out[p]);
  }
  for (std::size_t p = 0; p < out.size(); ++p) {
    if (out[p] == 0) out[p] = of_wholes[at(set.part_whole[p])];
    if (out[p] == 0) out[p] = 1;
  }
  return out;
}

/// Whether a jump in stiffness is to be looked for.
bool contrasts(const std::vector<double>& stiffness) {
  double least = 0, most = 0;
  for (const double s : stiffness) {
    most = std::max(most, s);
    if (s > 0 && (least == 0 || s < least)) least = s;
  }
  return most > kContrast * least;
}

}  // namespace

void find_parts(PointSet& set, const std::vector<double>& group_length, const std::vector<Joint>& joints) {
  std::vector<int> whole(at(set.node_count()));
  DisjointSets wholes = connect(set, joints);
  int parts = number_sets(wholes, whole);
  set.node_part = whole;
  if (const std::vector<double> stiffness = node_stiffness(set, joints); contrasts(stiffness)) {
    DisjointSets alike = connect_alike(set, joints, stiffness);
    parts = number_sets(alike, set.node_part);
  }
  set.part_whole.resize(at(parts));
  for (std::size_t i = 0; i < whole.size(); ++i) set.part_whole[at(set.node_part[i])] = whole[i];
  set.part_length = part_lengths(set, parts, group_length, joints);
}

}  // namespace fascia
