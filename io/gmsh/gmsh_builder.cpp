#include "io/gmsh/gmsh_builder.hpp"

#include "core/base/errors.hpp"
#include "io/mesh/mesh_edit.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

namespace fascia::io {
namespace {

constexpr std::int64_t largest_group = std::numeric_limits<int>::max();

constexpr std::array<int, 12> usual_order{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
constexpr std::array<int, 12> tetrahedron_order{0, 1, 2, 3, 5, 4};  // Gmsh: 01 12 20 03 23 13
// Gmsh: 01 03 04 12 15 23 26 37 45 47 56 67
constexpr std::array<int, 12> hexahedron_order{0, 3, 5, 1, 8, 10, 11, 9, 2, 4, 6, 7};

/// Places of a cell's mid-side nodes in Gmsh's list of them.
const std::array<int, 12>& mid_node_order(CellType type) {
  if (type == CellType::tetrahedron) return tetrahedron_order;
  return type == CellType::hexahedron ? hexahedron_order : usual_order;
}

}  // namespace

GmshElement gmsh_element(std::int64_t number, const GmshInput& input) {
  using enum CellType;
  switch (number) {
    case 1:
      return {line, 2};
    case 2:
      return {triangle, 3};
    case 3:
      return {quadrilateral, 4};
    case 4:
      return {tetrahedron, 4};
    case 5:
      return {hexahedron, 8};
    case 6:
      return {wedge, 6};
    case 7:
      return {pyramid, 5};
    case 8:
      return {line, 3, true};
    case 9:
      return {triangle, 6, true};
    case 10:
      return {quadrilateral, 9, true};
    case 11:
      return {tetrahedron, 10, true};
    case 12:
      return {hexahedron, 27, true};
    case 13:
      return {wedge, 18};
    case 14:
      return {pyramid, 14};
    case 15:
      return {vertex, 1};
    case 16:
      return {quadrilateral, 8, true};
    case 17:
      return {hexahedron, 20, true};
    case 18:
      return {wedge, 15};
    case 19:
      return {pyramid, 13};
    case 21:
      return {triangle, 10};
    case 23:
      return {triangle, 15};
    case 25:
      return {triangle, 21};
    case 26:
      return {line, 4};
    case 27:
      return {line, 5};
    case 28:
      return {line, 6};
    case 29:
      return {tetrahedron, 20};
    case 30:
      return {tetrahedron, 35};
    case 31:
      return {tetrahedron, 56};
    default:
      input.fail("element type " + std::to_string(number) +
                 " is not supported; save linear or quadratic elements (gmsh -order 1)");
  }
}

void GmshBuilder::reserve_nodes(std::size_t count) {
  mesh_.points.reserve(count);
  mesh_.point_file_number.reserve(count);
  index_.reserve(count);
}

void GmshBuilder::add_node(std::int64_t tag, const Vec3d& x) {
  if (!index_.try_emplace(tag, static_cast<int>(mesh_.points.size())).second)
    input_.fail("node " + std::to_string(tag) + " appears twice; number the nodes anew");
  mesh_.points.push_back(x);
  mesh_.point_file_number.push_back(tag);
  kept_.push_back(false);
  between_.push_back(false);
}

int GmshBuilder::group(int dimension, std::int64_t number) {
  if (number < -largest_group || number > largest_group)
    input_.fail("physical group " + std::to_string(number) + " is out of range; must be at most 2147483647");
  number = number < 0 ? -number : number;  // the sign is an orientation that the cells have already
  const auto [entry, fresh] = groups_.try_emplace({dimension, number}, static_cast<int>(mesh_.groups.size()));
  if (fresh) mesh_.groups.push_back({std::to_string(number), static_cast<int>(number), dimension});
  return entry->second;
}

void GmshBuilder::name_group(int dimension, std::int64_t number, std::string name) {
  MeshGroup& named = mesh_.groups[static_cast<std::size_t>(group(dimension, number))];
  if (!name.empty()) named.name = std::move(name);
}

std::size_t GmshBuilder::index_of(std::int64_t tag, std::int64_t cell) const {
  const auto found = index_.find(tag);
  if (found == index_.end())
    input_.fail("element " + std::to_string(cell) + " uses node " + std::to_string(tag) +
                ", which the file does not have; add the node or remove the element");
  return static_cast<std::size_t>(found->second);
}

CellBlock& GmshBuilder::block(CellType type, int mid_nodes_per_cell) {
  for (CellBlock& block : mesh_.blocks)
    if (block.type == type && block.mid_nodes_per_cell == mid_nodes_per_cell) return block;
  mesh_.blocks.push_back({type, {}, {}, {}, mid_nodes_per_cell, {}});
  return mesh_.blocks.back();
}

void GmshBuilder::add_cell(const GmshElement& element, std::int64_t number, std::span<const std::int64_t> node_tags,
                           int group) {
  const bool quadratic = element.quadratic && mid_nodes_ == MidNodes::keep;
  CellBlock& cells = block(element.type, quadratic ? mid_node_count(element.type) : 0);
  const auto corners = static_cast<std::size_t>(node_count(element.type));
  const std::size_t kept = corners + static_cast<std::size_t>(cells.mid_nodes_per_cell);
  for (std::size_t n = 0; n < node_tags.size(); ++n) {
    const std::size_t node = index_of(node_tags[n], number);
    (n < kept ? kept_ : between_)[node] = true;
    if (n < corners) cells.nodes.push_back(static_cast<int>(node));
  }
  const std::array<int, 12>& order = mid_node_order(element.type);
  for (std::size_t m = 0; m < kept - corners; ++m) {
    const std::size_t place = corners + static_cast<std::size_t>(order[m]);
    cells.mid_nodes.push_back(static_cast<int>(index_of(node_tags[place], number)));
  }
  cells.group.push_back(group);
  cells.file_number.push_back(number);
}

Mesh GmshBuilder::finish(const std::string& name) {
  if (mesh_.blocks.empty()) throw InputError(name + ": the mesh has no cells; save the elements with the nodes");
  std::vector<bool> keep(kept_.size());
  for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = kept_[i] || !between_[i];
  keep_points(mesh_, keep);
  mesh_.file = name;
  return std::move(mesh_);
}

}  // namespace fascia::io
