#pragma once

#include "fem/element_mesh_parts.hpp"
#include "fem/from_mesh.hpp"

/// Steps of element_mesh(); for from_mesh*.cpp only.
namespace fascia::from_mesh_parts {

/// "FILE: " + message
[[noreturn]] void fail(const std::string& file, const std::string& message);

/// "3, 5, 8 and 12 more"
std::string first_few(const std::vector<std::int64_t>& numbers);

/// The blocks of the family's cells.
/// @throws InputError  none, or other volume cells beside them
std::vector<const CellBlock*> family_blocks(const Mesh& mesh, ElementFamily family);

/// The volume cells, each once, on the file's points, and the elements of each of the file's groups.
struct Cells {
  ElementMesh mesh;
  std::vector<std::vector<int>> elements_of_group;
};

/// Cells that repeat others are left out, with a message.
/// @throws InputError  cells of the same corners in another order, linear cells beside quadratic ones where order = 2
Cells distinct_cells(const Mesh& mesh, ElementFamily family, int order);

/// @throws InputError  a node twice in an element, flat elements, a mixture of orientations
void check_corners(ElementMesh& mesh);

/// @throws InputError  an edge with two middle nodes
void check_middles(const ElementMesh& mesh);

/// @throws InputError  elements whose volume vanishes or turns over at an integration point
void check_folds(const ElementMesh& mesh);

/// @throws InputError  faces of more than two elements, or of two on the same side
void check_faces(ElementMesh& mesh);

/// Drops nodes that no element uses and numbers the others anew. `kept` receives each former node's index or −1.
/// `middle` flags nodes that lie on edges of cells, which are dropped in silence.
void drop_unused(ElementMesh& mesh, const std::vector<char>& middle, std::vector<int>& kept);

}  // namespace fascia::from_mesh_parts
