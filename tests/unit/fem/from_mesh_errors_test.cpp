#include "fem/from_mesh.hpp"
#include "tests/unit/fem/fem_samples.hpp"

#include <limits>

namespace fascia::from_mesh_errors_test {
namespace {

using namespace samples;

std::string error_of(const Mesh& mesh, ElementFamily family, int order = 1) {
  return input_error([&] { element_mesh(mesh, family, order); });
}

Mesh boxes(const ElementKind& kind) { return file_of(generate_box({{0, 0, 0}}, {{3, 1, 1}}, {3, 1, 1}, kind)); }

void append_cell(Mesh& mesh, const std::vector<int>& nodes, std::int64_t number, int group = -1) {
  mesh.blocks[0].nodes.insert(mesh.blocks[0].nodes.end(), nodes.begin(), nodes.end());
  mesh.blocks[0].file_number.push_back(number);
  mesh.blocks[0].group.push_back(group);
}

std::vector<int> cell_of(const Mesh& mesh, std::size_t cell) {
  const std::size_t n = at(node_count(mesh.blocks[0].type));
  const auto begin = mesh.blocks[0].nodes.begin() + static_cast<std::ptrdiff_t>(cell * n);
  return {begin, begin + static_cast<std::ptrdiff_t>(n)};
}

TEST(FromMeshErrors, no_cells_of_the_family) {
  EXPECT_EQ(error_of(boxes(hexahedra), ElementFamily::tetrahedra),
            "sample.msh: holds hexahedra, no tetrahedra; use model = \"hexahedra\"");
  EXPECT_EQ(error_of(boxes(tetrahedra), ElementFamily::hexahedra),
            "sample.msh: holds tetrahedra, no hexahedra; use model = \"tetrahedra\"");
  const std::vector<Vec3d> points = boxes(hexahedra).points;
  expect_contains(error_of(mesh_of(CellType::triangle, points, {0, 1, 4}), ElementFamily::tetrahedra),
                  "holds triangles only; give a volume mesh of tetrahedra");
  expect_contains(error_of(mesh_of(CellType::wedge, points, {0, 1, 4, 8, 9, 12}), ElementFamily::tetrahedra),
                  "holds wedges, which make no elements here; mesh it with tetrahedra");
  expect_contains(error_of(mesh_of(CellType::triangle, points, {}), ElementFamily::tetrahedra), "holds no cells");
}

TEST(FromMeshErrors, several_types_of_volume_cells) {
  Mesh mesh = boxes(hexahedra);
  CellBlock wedge = mesh_of(CellType::wedge, mesh.points, {0, 1, 4, 8, 9, 12}).blocks[0];
  mesh.blocks.push_back(wedge);
  expect_contains(error_of(mesh, ElementFamily::hexahedra),
                  "mixes 3 hexahedra with 1 wedges; give volume cells of one");
  Mesh orders = boxes(tetrahedra_2);
  orders.blocks.push_back(mesh_of(CellType::tetrahedron, orders.points, {0, 1, 5, 8}).blocks[0]);
  orders.blocks[1].file_number = {99};
  expect_contains(error_of(orders, ElementFamily::tetrahedra, 2), "mixes linear and quadratic tetrahedra");
}

TEST(FromMeshErrors, order_and_coordinates) {
  expect_contains(error_of(boxes(hexahedra), ElementFamily::hexahedra, 3), "order 3; must be 1 or 2");
  Mesh mesh = boxes(hexahedra);
  mesh.points[4][1] = std::numeric_limits<double>::quiet_NaN();
  expect_contains(error_of(mesh, ElementFamily::hexahedra), "node 5 has a coordinate that is no finite number");
}

TEST(FromMeshErrors, node_twice) {
  Mesh mesh = boxes(hexahedra);
  mesh.blocks[0].nodes[8 + 2] = mesh.blocks[0].nodes[8 + 1];
  expect_contains(error_of(mesh, ElementFamily::hexahedra),
                  "sample.msh: element 2 uses node 3 twice; must have 8 different nodes");
  Mesh curved = boxes(tetrahedra_2);
  curved.blocks[0].mid_nodes[6 * 4] = curved.blocks[0].mid_nodes[6 * 4 + 1];
  expect_contains(error_of(curved, ElementFamily::tetrahedra, 2), "element 5 uses node");
}

TEST(FromMeshErrors, flat_elements) {
  Mesh mesh = boxes(tetrahedra);
  append_cell(mesh, {0, 1, 2, 5}, 50);
  expect_contains(error_of(mesh, ElementFamily::tetrahedra), "element 50 is flat");
}

TEST(FromMeshErrors, repeated_elements) {
  Mesh mesh = boxes(hexahedra);
  append_cell(mesh, cell_of(mesh, 1), 9);
  const ElementMesh once = element_mesh(mesh, ElementFamily::hexahedra, 1);
  EXPECT_EQ(once.size(), 3u);
  EXPECT_EQ(once.messages, std::vector<std::string>{"sample.msh: left out 1 element that repeats another (element 9, "
                                                    "which repeats element 2)"});
  // Files that write a cell once for each of its groups may number it anew.
  mesh.groups = {{"a", 1, 3}, {"b", 2, 3}};
  mesh.blocks[0].group = {-1, 0, -1, 1};
  EXPECT_EQ(element_mesh(mesh, ElementFamily::hexahedra, 1).size(), 3u);
  mesh.blocks[0].group = {-1, 1, -1, 1};
  EXPECT_EQ(element_mesh(mesh, ElementFamily::hexahedra, 1).messages.size(), 2u) << "and one of a group without nodes";
  std::swap(mesh.blocks[0].nodes[24], mesh.blocks[0].nodes[25]);
  EXPECT_EQ(error_of(mesh, ElementFamily::hexahedra),
            "sample.msh: elements 2 and 9 have the same nodes; remove one of them");

  Mesh four = boxes(tetrahedra);
  const std::vector<int> first = cell_of(four, 0);
  append_cell(four, {first[1], first[0], first[2], first[3]}, 50);
  EXPECT_EQ(element_mesh(four, ElementFamily::tetrahedra, 1).size(), boxes(tetrahedra).blocks[0].size());
}

TEST(FromMeshErrors, mixed_orientation) {
  Mesh mesh = file_of(generate_box({{0, 0, 0}}, {{3, 1, 1}}, {3, 1, 1}, tetrahedra));
  for (const std::size_t c : {1u, 4u, 5u, 9u, 10u})
    std::swap(mesh.blocks[0].nodes[4 * c], mesh.blocks[0].nodes[4 * c + 1]);
  expect_contains(error_of(mesh, ElementFamily::tetrahedra),
                  "elements 2, 5, 6 and 2 more are turned the wrong way round (5 of 18 elements); number the nodes");
  for (Vec3d& X : mesh.points) X[0] = -X[0];
  expect_contains(error_of(mesh, ElementFamily::tetrahedra), "elements 2, 5, 6 and 2 more are turned against");
}

TEST(FromMeshErrors, folded_elements) {
  Mesh mesh = boxes(hexahedra_2);
  const int middle = mesh.blocks[0].mid_nodes[12 + 1];  // of the second element, shared with the third
  mesh.points[at(middle)] += Vec3d{{1.5, 0, 0}};
  expect_contains(error_of(mesh, ElementFamily::hexahedra, 2), "element 3 is folded");
  EXPECT_EQ(element_mesh(mesh, ElementFamily::hexahedra, 1).size(), 3u);
  Mesh twisted = mesh_of(CellType::hexahedron, boxes(hexahedra).points, {0, 1, 5, 4, 8, 9, 13, 12});
  twisted.points[13] = {{-0.9, -0.9, 0.2}};
  expect_contains(error_of(twisted, ElementFamily::hexahedra), "element 1 is folded");
}

TEST(FromMeshErrors, two_middle_nodes_at_an_edge) {
  Mesh mesh = boxes(hexahedra_2);
  int& middle = mesh.blocks[0].mid_nodes[12 + 3];  // shared with the first element
  mesh.points.push_back(mesh.points[at(middle)]);
  mesh.point_file_number.push_back(500);
  middle = static_cast<int>(mesh.points.size()) - 1;
  const std::string message = error_of(mesh, ElementFamily::hexahedra, 2);
  expect_contains(message, "elements 1 and 2 have different nodes");
  expect_contains(message, "and 500) in the middle of the edge from node 6 to node 2; must share one");
}

TEST(FromMeshErrors, faces_of_three_elements_and_overlaps) {
  Mesh mesh =
      mesh_of(CellType::tetrahedron, {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}, {{0, 0, 2}}, {{0, 0, -1}}},
              {0, 1, 2, 3, 0, 1, 2, 4, 0, 2, 1, 5});
  expect_contains(error_of(mesh, ElementFamily::tetrahedra), "elements 1, 2 and 3 share a face");
  mesh.blocks[0].nodes.resize(8);
  mesh.blocks[0].group.resize(2);
  expect_contains(error_of(mesh, ElementFamily::tetrahedra),
                  "elements 1 and 2 overlap: they lie on the same side of a common face");
}

}  // namespace
}  // namespace fascia::from_mesh_errors_test
