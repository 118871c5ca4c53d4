#include "core/structure/element_block.hpp"

#include "core/base/coloring.hpp"
#include "core/base/errors.hpp"
#include "core/base/incidence.hpp"
#include "core/base/index.hpp"
#include "core/physics/solid_law.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <unordered_map>
#include <utility>

namespace fascia {

namespace {

/// Integration points of a patch, of elements that have several: a patch is worth a thread's while, its nodes'
/// displacements and forces stay in the first cache, and patches of one colour are enough for many threads.
constexpr int kPatchPoints = 512;
constexpr int kFewestElements = 32, kMostElements = 256;  ///< of a patch

/// Places of an element's nodes in ascending order of the nodes: blocks of pairs then all lie on one side of the
/// diagonal.
std::vector<int> ascending(const ElementBlockSpec& spec, std::size_t e) {
  std::vector<int> order(at(spec.nodes));
  std::iota(order.begin(), order.end(), 0);
  const int* node = spec.node.data() + e * at(spec.nodes);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return node[a] < node[b]; });
  return order;
}

void fill_batch(const ElementBlockSpec& spec, int batch, ElementBlock& block) {
  const int elements = block.count;
  for (int lane = 0; lane < kElementLanes; ++lane) {
    const int own = batch * kElementLanes + lane;
    const bool used = own < elements;
    const auto e = at(std::min(own, elements - 1));
    const std::vector<int> order = ascending(spec, e);
    for (int q = 0; q < spec.points; ++q) {
      const std::size_t point = e * at(spec.points) + at(q), place = at(batch * spec.points + q);
      block.volume[place * kElementLanes + at(lane)] = used ? spec.volume[point] : 0.0;
      for (int a = 0; a < spec.nodes; ++a)
        for (int k = 0; k < 3; ++k)
          block.gradient[((place * at(spec.nodes) + at(a)) * 3 + at(k)) * kElementLanes + at(lane)] =
              spec.gradient[point * at(spec.nodes) + at(order[at(a)])][k];
    }
    const ElementMaterialSpec m = used ? spec.material[e] : ElementMaterialSpec{};
    double* rows = block.material.data() + at(batch * block.material_rows()) * kElementLanes + at(lane);
    rows[ElementBlock::kLambda * kElementLanes] = m.lambda;
    rows[ElementBlock::kMu * kElementLanes] = m.mu;
    rows[ElementBlock::kStiffnessDamping * kElementLanes] = m.stiffness_damping;
    rows[ElementBlock::kPenalty * kElementLanes] = m.penalty;
    for (std::size_t k = 0; k < std::min(m.own.size(), at(block.own_constants)); ++k)
      rows[(ElementBlock::kOwnConstants + k) * kElementLanes] = m.own[k];
    block.penalised = block.penalised || m.penalty > 0;
    block.damped = block.damped || m.stiffness_damping > 0;
  }
}

void number_patch(const ElementBlockSpec& spec, int first_batch, int last_batch, ElementBlock& block) {
  std::unordered_map<int, std::uint16_t> number;
  for (int batch = first_batch; batch < last_batch; ++batch) {
    for (int lane = 0; lane < kElementLanes; ++lane) {
      const auto e = at(std::min(batch * kElementLanes + lane, block.count - 1));
      const std::vector<int> order = ascending(spec, e);
      for (int a = 0; a < spec.nodes; ++a) {
        const int node = spec.node[e * at(spec.nodes) + at(order[at(a)])];
        const auto [entry, fresh] = number.try_emplace(node, static_cast<std::uint16_t>(number.size()));
        if (fresh) block.patch_node.push_back(node);
        block.local[at((batch * spec.nodes + a) * kElementLanes + lane)] = entry->second;
      }
    }
  }
  block.patch_batch.push_back(last_batch);
  block.patch_begin.push_back(block.slot_count());
}

/// Where strains are averaged, all elements of the block must fade alike: an average has no part that fades by itself.
void check_fading(const ElementBlockSpec& spec) {
  for (const ElementMaterialSpec& m : spec.material) {
    const auto& first = spec.material[0].viscosity;
    if (m.viscosity) check_viscosity(spec.law, *m.viscosity, m.stiffness_damping);
    if (spec.averaged && (!fade_alike(m.viscosity, first) || (first && first->shear_only)))
      throw InputError(
          "elements with averaged volumes must have one viscosity, of all their stiffness; give all the same, or do "
          "not average");
  }
}

void add_beside(const ElementBlockSpec& spec, ElementBlock& block) {
  block.source = spec.source;
  const auto points = at(spec.points);
  if (!spec.active.empty() && spec.active.size() != spec.material.size() * points)
    throw InputError("a block of elements has " + std::to_string(spec.active.size()) + " active stresses for " +
                     std::to_string(spec.material.size() * points) + " points; give one a point, or none");
  for (std::size_t e = 0; e < spec.material.size(); ++e)
    for (std::size_t q = 0; q < points; ++q) {
      const ElementMaterialSpec& m = spec.material[e];
      const StressBeside beside{m.viscosity, spec.active.empty() ? m.active : spec.active[e * points + q]};
      if (!beside) continue;
      block.beside.resize(at(block.batch_count()) * points * kElementLanes);
      block.beside[(e / kElementLanes * points + q) * kElementLanes + e % kElementLanes] = beside;
    }
}

}  // namespace

ElementBlock make_element_block(const ElementBlockSpec& spec) {
  ElementBlock block;
  block.law = spec.law;
  block.averaged = spec.averaged;
  block.nodes = spec.nodes;
  block.points = spec.points;
  block.length = spec.length;
  block.count = static_cast<int>(spec.material.size());
  block.own_constants = own_constant_count(spec.law);
  for (const ElementMaterialSpec& m : spec.material) check_own_constants(spec.law, m);
  check_fading(spec);
  add_beside(spec, block);
  const auto batches = at(block.batch_count());
  block.gradient.resize(batches * at(spec.points) * at(spec.nodes) * 3 * kElementLanes);
  block.volume.resize(batches * at(spec.points) * kElementLanes);
  block.material.resize(batches * at(block.material_rows()) * kElementLanes);
  block.local.resize(batches * at(spec.nodes) * kElementLanes);
  const int batches_a_patch = std::clamp(kPatchPoints / spec.points, kFewestElements, kMostElements) / kElementLanes;
  for (int batch = 0; batch < block.batch_count(); ++batch) fill_batch(spec, batch, block);
  for (int batch = 0; batch < block.batch_count(); batch += batches_a_patch)
    number_patch(spec, batch, std::min(batch + batches_a_patch, block.batch_count()), block);
  return block;
}

double ElementBlock::stiffness_sum() const {
  double sum = 0;
  for (int batch = 0; batch < batch_count(); ++batch) {
    for (int q = 0; q < points; ++q) {
      for (int lane = 0; lane < kElementLanes; ++lane) {
        double squares = 0;
        for (int k = 0; k < 3 * nodes; ++k) {
          const double g = gradient_of(batch, q)[k * kElementLanes + lane];
          squares += g * g;
        }
        sum += volume_of(batch, q)[lane] * lame_of(batch * kElementLanes + lane).wave_modulus() * squares;
      }
    }
  }
  return sum;
}

LawConstants ElementBlock::constants_of(int element) const {
  const double* rows = material_of(element / kElementLanes) + element % kElementLanes;
  LawConstants c;
  c.lambda = rows[kLambda * kElementLanes];
  c.mu = rows[kMu * kElementLanes];
  for (int k = 0; k < own_constants; ++k) c.own.push_back(rows[(kOwnConstants + k) * kElementLanes]);
  return c;
}

void finish_element_block(ElementBlock& block, int nodes_of_model) {
  const auto for_each_slot = [&](const auto& act) {
    for (int slot = 0; slot < block.slot_count(); ++slot) act(block.patch_node[at(slot)], slot);
  };
  list_by_node(nodes_of_model, for_each_slot, block.node_slot_begin, block.node_slot);
  Coloring colors =
      color_items(block.patch_count(), nodes_of_model, [&](int patch) { return block.nodes_of_patch(patch); });
  block.color_begin = std::move(colors.begin);
  block.color_patch = std::move(colors.item);
}

}  // namespace fascia
