#include "core/structure/shell_block.hpp"

#include "core/base/coloring.hpp"
#include "core/base/incidence.hpp"
#include "core/base/index.hpp"
#include "core/physics/solid_law.hpp"

#include <algorithm>
#include <utility>

namespace fascia {

namespace {

/// Place of the packed entry (i, j).
std::size_t packed(std::size_t i, std::size_t j) { return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i; }

/// The same triangle with corner order[a] at place a.
ShellElementSpec reordered(const ShellElementSpec& e, const std::array<std::size_t, 3>& order) {
  ShellElementSpec r = e;
  std::array<std::size_t, 6> membrane{0, 1, 2}, bending{};
  for (std::size_t a = 0; a < 3; ++a) {
    r.node[a] = e.node[order[a]];
    std::copy_n(e.constants.g[order[a]], 2, r.constants.g[a]);
    membrane[3 + a] = 3 + order[a];
    bending[2 * a] = 2 * order[a];
    bending[2 * a + 1] = 2 * order[a] + 1;
  }
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      r.constants.membrane[packed(i, j)] = e.constants.membrane[packed(membrane[i], membrane[j])];
      r.constants.bending[packed(i, j)] = e.constants.bending[packed(bending[i], bending[j])];
    }
  return r;
}

ShellElementSpec ascending(const ShellElementSpec& e) {
  std::array<std::size_t, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return e.node[a] < e.node[b]; });
  return reordered(e, order);
}

void fill_lane(const ShellElementSpec& e, bool used, std::size_t batch, std::size_t lane, ShellBlock& block) {
  for (std::size_t a = 0; a < 3; ++a) block.node[(batch * 3 + a) * kElementLanes + lane] = e.node[a];
  double* rows = block.constants.data() + batch * ShellBlock::kRows * kElementLanes + lane;
  const auto set = [&](int row, double value) { rows[row * kElementLanes] = value; };
  for (int a = 0; a < 3; ++a)
    for (int j = 0; j < 2; ++j) set(ShellBlock::kGradients + 2 * a + j, e.constants.g[a][j]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) set(ShellBlock::kAxes + 3 * i + j, e.axes(i, j));
  if (!used) return;
  for (int k = 0; k < kPacked6; ++k) {
    set(ShellBlock::kMembrane + k, e.constants.membrane[k]);
    set(ShellBlock::kBending + k, e.constants.bending[k]);
  }
  set(ShellBlock::kDamping, e.stiffness_damping);
}

}  // namespace

ShellBlock make_shell_block(std::span<const ShellElementSpec> elements, double length) {
  ShellBlock block;
  block.count = static_cast<int>(elements.size());
  block.length = length;
  const auto batches = at(block.batch_count());
  block.node.resize(batches * 3 * kElementLanes);
  block.constants.resize(batches * ShellBlock::kRows * kElementLanes);
  for (std::size_t e = 0; e < batches * kElementLanes; ++e) {
    const bool used = e < elements.size();
    fill_lane(ascending(used ? elements[e] : elements.back()), used, e / kElementLanes, e % kElementLanes, block);
    block.damped = block.damped || (used && elements[e].stiffness_damping > 0);
    if (!used) continue;
    block.source.push_back(elements[e].source);
    if (elements[e].viscosity == nullptr) continue;
    check_viscosity(Law::sheet, *elements[e].viscosity, elements[e].stiffness_damping);
    block.viscosity.resize(batches * kElementLanes);
    block.viscosity[e] = elements[e].viscosity;
  }
  return block;
}

std::vector<StressBeside> ShellBlock::beside_of_lanes() const {
  std::vector<StressBeside> all;
  for (std::size_t first = 0; first < viscosity.size(); first += kElementLanes) {
    for (int part = 0; part < 2; ++part)
      for (std::size_t lane = first; lane < first + kElementLanes; ++lane) all.push_back({viscosity[lane], {}});
  }
  return all;
}

double ShellBlock::stiffness_sum() const {
  double sum = 0;
  for (int e = 0; e < count; ++e) {
    const double* rows = constants_of(e / kElementLanes) + e % kElementLanes;
    double squares = 0;
    for (int k = 0; k < 6; ++k) {
      const double g = rows[(kGradients + k) * kElementLanes];
      squares += g * g;
    }
    sum += rows[kMembrane * kElementLanes] * squares;
  }
  return sum;
}

void finish_shell_block(ShellBlock& block, int nodes_of_model) {
  const auto for_each_corner = [&](const auto& act) {
    for (int e = 0; e < block.count; ++e)
      for (int a = 0; a < 3; ++a) act(block.element(e)[at(a)], 3 * e + a);
  };
  list_by_node(nodes_of_model, for_each_corner, block.node_slot_begin, block.node_slot);
  Coloring colors = color_items(block.batch_count(), nodes_of_model,
                                [&](int batch) { return std::span(block.nodes_of(batch), 3 * kElementLanes); });
  block.color_begin = std::move(colors.begin);
  block.color_batch = std::move(colors.item);
}

}  // namespace fascia
