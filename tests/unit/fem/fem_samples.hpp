#pragma once

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "fem/generate.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

/// Small meshes for the tests of this folder.
namespace fascia::samples {

inline constexpr std::array<ElementShape, 4> all_shapes{ElementShape::tet4, ElementShape::tet10, ElementShape::hex8,
                                                        ElementShape::hex20};

inline const ElementKind hexahedra{ElementFamily::hexahedra, 1, 6};
inline const ElementKind hexahedra_2{ElementFamily::hexahedra, 2, 6};
inline const ElementKind tetrahedra{ElementFamily::tetrahedra, 1, 6};
inline const ElementKind tetrahedra_2{ElementFamily::tetrahedra, 2, 6};
inline const ElementKind by_five{ElementFamily::tetrahedra, 1, 5};
inline const ElementKind by_five_2{ElementFamily::tetrahedra, 2, 5};

/// A place in the reference element, away from its border.
inline Vec3d random_place(ElementShape shape, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  Vec3d xi{{unit(random), unit(random), unit(random)}};
  if (family_of(shape) == ElementFamily::hexahedra) return 1.98 * (xi - Vec3d{{0.5, 0.5, 0.5}});
  return xi * (0.99 / (xi[0] + xi[1] + xi[2] + unit(random)));
}

/// A mesh file of one block, numbered from 1, with one group a cell that is given (−1: none).
inline Mesh mesh_of(CellType type, std::vector<Vec3d> points, std::vector<int> nodes) {
  Mesh mesh;
  mesh.file = "sample.msh";
  mesh.points = std::move(points);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) mesh.point_file_number.push_back(static_cast<int>(i) + 1);
  CellBlock block;
  block.type = type;
  block.nodes = std::move(nodes);
  block.group.assign(block.size(), -1);
  for (std::size_t c = 0; c < block.size(); ++c) block.file_number.push_back(static_cast<int>(c) + 1);
  mesh.blocks.push_back(std::move(block));
  return mesh;
}

/// A generated mesh as a file would hold it.
inline Mesh file_of(const ElementMesh& elements) {
  const bool tetrahedral = family_of(elements.shape) == ElementFamily::tetrahedra;
  const std::size_t corners = at(corner_count(elements.shape));
  std::vector<int> nodes, middles;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const auto element = elements.element(e);
    nodes.insert(nodes.end(), element.begin(), element.begin() + static_cast<std::ptrdiff_t>(corners));
    middles.insert(middles.end(), element.begin() + static_cast<std::ptrdiff_t>(corners), element.end());
  }
  Mesh mesh = mesh_of(tetrahedral ? CellType::tetrahedron : CellType::hexahedron, elements.nodes, nodes);
  mesh.blocks[0].mid_nodes = middles;
  mesh.blocks[0].mid_nodes_per_cell = node_count(elements.shape) - static_cast<int>(corners);
  return mesh;
}

inline double volume_of(const ElementMesh& mesh) {
  double volume = 0;
  for (std::size_t e = 0; e < mesh.size(); ++e) volume += element_volume(mesh, e);
  return volume;
}

/// The message of the InputError that `act` throws; fails the test where it throws none.
template <class Act>
std::string input_error(Act&& act) {
  try {
    act();
  } catch (const InputError& e) {
    return e.what();
  }
  ADD_FAILURE() << "no InputError";
  return {};
}

inline void expect_contains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "\"" << part << "\" is not in \"" << text << "\"";
}

}  // namespace fascia::samples
