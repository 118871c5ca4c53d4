#include "core/base/index.hpp"
#include "core/geometry/primitives.hpp"
#include "io/mesh/mesh_reader.hpp"
#include "shells/shell_mesh.hpp"
#include "shells/surface_checks.hpp"
#include "tests/support/paths.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <utility>

// From a mesh as a file holds it to a shell's surface: what is kept, what is repaired and said.
namespace fascia::from_surface_test {
namespace {

using samples::cube_points;
using samples::mesh_of;

using Messages = std::vector<std::string>;

/// Two triangles over the unit square.
Mesh square() {
  return mesh_of(CellType::triangle, {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0}}, {{0, 1, 0}}}, {0, 1, 2, 0, 2, 3});
}

void add_block(Mesh& mesh, CellType type, std::vector<int> nodes, int group, std::int64_t first_number) {
  CellBlock block{type, std::move(nodes), {}, {}};
  block.group.assign(block.size(), group);
  for (std::size_t c = 0; c < block.size(); ++c)
    block.file_number.push_back(first_number + static_cast<std::int64_t>(c));
  mesh.blocks.push_back(std::move(block));
}

TEST(ShellFromSurface, TrianglesAreKeptInOrder) {
  const ShellMesh shell = shell_mesh(square());
  EXPECT_EQ(shell.file, "sample.msh");
  EXPECT_EQ(shell.nodes, square().points);
  EXPECT_EQ(shell.triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(shell.file_number, (std::vector<std::int64_t>{1, 2}));
  EXPECT_EQ(shell.messages, Messages{});
}

TEST(ShellFromSurface, QuadrilateralsAreSplit) {
  const ShellMesh shell = shell_mesh(mesh_of(CellType::quadrilateral, cube_points(), {4, 5, 6, 7, 1, 2, 6, 5}));
  EXPECT_EQ(shell.triangles.size(), 4u);
  EXPECT_EQ(shell.file_number, (std::vector<std::int64_t>{1, 1, 2, 2}));
  EXPECT_DOUBLE_EQ(area(shell), 2);
  EXPECT_EQ(shell.messages, Messages{"sample.msh: left out 2 points that no cell uses (the first: node 1)"});
}

/// Directed edges, each of which one triangle may have.
std::set<std::pair<int, int>> directed_edges(const ShellMesh& shell) {
  std::set<std::pair<int, int>> edges;
  for (const auto& t : shell.triangles)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(edges.insert({t[k], t[(k + 1) % 3]}).second);
  return edges;
}

TEST(ShellFromSurface, SkinThatTouchesItselfIsSplitThere) {
  // Two cubes along an edge, as one closed skin with a group of its own for the triangles of the second.
  std::vector<Vec3d> points = cube_points();
  points.insert(points.end(), {{{2, 1, 0}}, {{2, 2, 0}}, {{1, 2, 0}}, {{2, 1, 1}}, {{2, 2, 1}}, {{1, 2, 1}}});
  Mesh mesh = mesh_of(CellType::hexahedron, points, {0, 1, 2, 3, 4, 5, 6, 7, 2, 8, 9, 10, 6, 11, 12, 13});
  mesh.groups = {{"second", 5, 3}};
  mesh.blocks[0].group = {-1, 0};
  const ShellMesh shell = shell_mesh(mesh);
  EXPECT_EQ(shell.nodes.size(), 15u) << "in one node the cubes stay joined, or one would be loose";
  EXPECT_EQ(shell.triangles.size(), 24u);
  EXPECT_DOUBLE_EQ(area(shell), 12);
  for (const auto& [a, b] : directed_edges(shell)) EXPECT_TRUE(directed_edges(shell).contains({b, a}));
  ASSERT_EQ(shell.messages.size(), 2u);
  EXPECT_EQ(
      shell.messages[1],
      "sample.msh: touches itself along 1 edge, at (1, 1, 0.5); split there: what met is not joined, but in one node "
      "where a part would come loose (1)");
  ASSERT_EQ(shell.groups.size(), 1u);
  EXPECT_EQ(shell.groups[0].cells.size(), 12u);
  EXPECT_EQ(shell.groups[0].nodes.size(), 8u) << "and nothing of the other cube";
  for (const int t : shell.groups[0].cells)
    for (const int node : shell.triangles[at(t)])
      EXPECT_TRUE(std::ranges::count(shell.groups[0].nodes, node) == 1) << "copies are in the group too";
}

TEST(ShellFromSurface, GroupsOfWhatTouchesHaveTheirOwnSide) {
  // The same two cubes, each a group; and the edge between them, which has the nodes of both sides.
  std::vector<Vec3d> points = cube_points();
  points.insert(points.end(), {{{2, 1, 0}}, {{2, 2, 0}}, {{1, 2, 0}}, {{2, 1, 1}}, {{2, 2, 1}}, {{1, 2, 1}}});
  Mesh mesh = mesh_of(CellType::quadrilateral, points,
                      {0, 3,  2, 1, 4, 5,  6,  7,  0, 1, 5,  4, 1, 2, 6,  5,  2, 3,  7,  6,  3,  0, 4, 7,
                       2, 10, 9, 8, 6, 11, 12, 13, 2, 8, 11, 6, 8, 9, 12, 11, 9, 10, 13, 12, 10, 2, 6, 13});
  mesh.groups = {{"left", 1, 2}, {"right", 2, 2}, {"seam", 3, 1}};
  for (std::size_t c = 0; c < 12; ++c) mesh.blocks[0].group[c] = c < 6 ? 0 : 1;
  add_block(mesh, CellType::line, {2, 6}, 2, 13);
  const ShellMesh shell = shell_mesh(mesh);
  ASSERT_EQ(shell.groups.size(), 3u);
  EXPECT_EQ(shell.groups[2].nodes.size(), 3u);
  for (std::size_t g = 0; g < 2; ++g) {
    std::set<int> used;
    for (const int t : shell.groups[g].cells) used.insert(shell.triangles[at(t)].begin(), shell.triangles[at(t)].end());
    EXPECT_EQ(shell.groups[g].nodes, std::vector<int>(used.begin(), used.end())) << g;
    EXPECT_EQ(used.size(), 8u);
  }
}

TEST(ShellFromSurface, GroupsOfVolumeCellsWithOneNumber) {
  const std::vector<Vec3d> points{{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}},
                                  {{3, 0, 0}}, {{4, 0, 0}}, {{3, 1, 0}}, {{3, 0, 1}}};
  Mesh mesh = mesh_of(CellType::tetrahedron, points, {0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7});
  mesh.groups = {{"A", 1, 3}, {"B", 2, 3}, {"C", 3, 3}};
  mesh.blocks[0].group = {0, 1, 2};
  mesh.blocks[0].file_number = {1, 1, 1};
  const ShellMesh shell = shell_mesh(mesh);
  const std::vector<int> a = shell.groups[0].cells, b = shell.groups[1].cells;
  EXPECT_EQ(a.size(), 4u);
  EXPECT_EQ(b.size(), 4u);
  for (const int t : a) EXPECT_EQ(std::ranges::count(b, t), 0);
  EXPECT_EQ(shell.groups[2].cells, b) << "it repeats the cell of B";
}

TEST(ShellFromSurface, ConcaveQuadrilateralsAreCutInside) {
  const std::vector<Vec3d> points{{{0, 0, 0}}, {{2, 1, 0}}, {{0, 2, 0}}, {{1, 1, 0}}};
  for (int start = 0; start < 4; ++start) {
    std::vector<int> nodes;
    for (int n = 0; n < 4; ++n) nodes.push_back((start + n) % 4);
    EXPECT_DOUBLE_EQ(area(shell_mesh(mesh_of(CellType::quadrilateral, points, nodes))), 1) << start;
    std::vector<Vec3d> moved;  // the same shape from another corner
    for (const int n : nodes) moved.push_back(points[at(n)]);
    EXPECT_DOUBLE_EQ(area(shell_mesh(mesh_of(CellType::quadrilateral, moved, {0, 1, 2, 3}))), 1) << start;
    EXPECT_DOUBLE_EQ(area(shell_mesh(mesh_of(CellType::quadrilateral, moved, {3, 2, 1, 0}))), 1) << start;
  }
}

TEST(ShellFromSurface, EdgeWhoseEndsHangTogetherGetsANodeInItsMiddle) {
  // Cubes of a block, at random.
  std::mt19937 random(4);
  constexpr int size = 4, n = size + 1;
  std::size_t halved = 0;
  for (int round = 0; round < 60; ++round) {
    std::vector<Vec3d> points;
    for (int p = 0; p < n * n * n; ++p) points.push_back({{1.0 * (p % n), 1.0 * (p / n % n), 1.0 * (p / (n * n))}});
    std::vector<int> nodes;
    for (int c = 0; c < size * size * size; ++c) {
      if (random() % 3 == 0) continue;
      const int a = c % size + n * (c / size % size + n * (c / (size * size))), b = a + n, up = n * n;
      nodes.insert(nodes.end(), {a, a + 1, b + 1, b, a + up, a + 1 + up, b + 1 + up, b + up});
    }
    const Mesh mesh = mesh_of(CellType::hexahedron, points, nodes);
    const ShellMesh shell = shell_mesh(mesh);
    const std::set<std::pair<int, int>> edges = directed_edges(shell);
    for (const auto& [a, b] : edges) EXPECT_TRUE(edges.contains({b, a})) << "closed";
    EXPECT_TRUE(closed(shell));
    ASSERT_EQ(shell.file_number.size(), shell.triangles.size());
    const double faces = std::round(area(shell));
    EXPECT_NEAR(area(shell), faces, 1e-9);
    halved += shell.triangles.size() - static_cast<std::size_t>(2 * faces);
  }
  EXPECT_GT(halved, 50u);
}

TEST(ShellFromSurface, GroupsHaveTrianglesAndNodes) {
  Mesh mesh = square();
  mesh.groups = {{"wall", 7, 2}, {"rim", 8, 1}, {"tip", 9, 0}, {"elsewhere", 10, 0}, {"both", 11, 2}};
  mesh.points.push_back({{5, 5, 5}});
  mesh.point_file_number.push_back(5);
  mesh.blocks[0].group = {-1, 0};
  add_block(mesh, CellType::line, {0, 1, 1, 2}, 1, 3);
  add_block(mesh, CellType::vertex, {3}, 2, 5);
  add_block(mesh, CellType::vertex, {4}, 3, 6);
  add_block(mesh, CellType::triangle, {3, 2, 0, 1, 2, 0}, 4, 7);  // repeats both, as of another group
  const ShellMesh shell = shell_mesh(mesh);
  ASSERT_EQ(shell.groups.size(), 5u);
  const auto expect = [&](std::size_t g, const char* name, std::vector<int> nodes, std::vector<int> cells) {
    EXPECT_EQ(shell.groups[g].name, name);
    EXPECT_EQ(shell.groups[g].nodes, nodes) << name;
    EXPECT_EQ(shell.groups[g].cells, cells) << name;
  };
  expect(0, "wall", {0, 2, 3}, {1});
  expect(1, "rim", {0, 1, 2}, {});
  expect(2, "tip", {3}, {});
  expect(3, "elsewhere", {}, {});
  expect(4, "both", {0, 1, 2, 3}, {0, 1});
  EXPECT_EQ(shell.triangles.size(), 2u);
  EXPECT_EQ(shell.nodes.size(), 4u);
  EXPECT_EQ(shell.messages, Messages{"sample.msh: group \"elsewhere\" has no nodes of the shell"});
}

TEST(ShellFromSurface, GroupsOfQuadrilateralsHaveBothHalves) {
  Mesh mesh = mesh_of(CellType::quadrilateral, cube_points(), {4, 5, 6, 7, 1, 2, 6, 5});
  mesh.groups = {{"side", 1, 2}};
  mesh.blocks[0].group = {-1, 0};
  EXPECT_EQ(shell_mesh(mesh).groups[0].cells, (std::vector<int>{2, 3}));
}

TEST(ShellFromSurface, DuplicateNodesAreWelded) {
  // As STL stores them: each triangle has nodes of its own.
  const TriangleMesh box = box_surface({}, {{1, 1, 1}}, 2, 2, 2);
  TriangleMesh apart;
  for (const auto& t : box.triangles) {
    const int first = static_cast<int>(apart.points.size());
    for (const int node : t) apart.points.push_back(box.points[at(node)]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  const ShellMesh shell = shell_mesh(mesh_of(apart));
  EXPECT_EQ(shell.nodes.size(), box.points.size());
  EXPECT_TRUE(closed(shell));
  EXPECT_EQ(shell.messages, Messages{"sample.msh: welded 118 points that coincide with others"});
}

TEST(ShellFromSurface, TrianglesAgainstTheirNeighboursTurnOver) {
  TriangleMesh box = box_surface({}, {{1, 1, 1}}, 2, 2, 2);
  for (const std::size_t t : {4u, 9u}) std::swap(box.triangles[t][0], box.triangles[t][1]);
  const ShellMesh shell = shell_mesh(mesh_of(box));
  EXPECT_NEAR(enclosed_volume(shell), 1, 1e-14);
  EXPECT_EQ(shell.messages, Messages{"sample.msh: turned over 2 of 48 triangles of sheets that disagreed with their "
                                     "neighbours (the first: triangle 5)"});
  for (auto& t : box.triangles) std::swap(t[0], t[1]);
  EXPECT_NEAR(enclosed_volume(shell_mesh(mesh_of(box))), 1, 1e-14) << "closed parts face outward";
}

TEST(ShellFromSurface, VolumeCellsGiveTheirBoundary) {
  Mesh mesh = mesh_of(CellType::hexahedron, cube_points(), {0, 1, 2, 3, 4, 5, 6, 7});
  mesh.groups = {{"organ", 1, 3}};
  mesh.blocks[0].group = {0};
  const ShellMesh shell = shell_mesh(mesh);
  EXPECT_NEAR(enclosed_volume(shell), 1, 1e-15);
  EXPECT_EQ(shell.messages, Messages{"sample.msh: has no triangles; the shell is the boundary of its 1 volume cells"});
  EXPECT_EQ(shell.groups[0].cells.size(), 12u);
  EXPECT_EQ(shell.groups[0].nodes.size(), 8u);
  add_block(mesh, CellType::triangle, {4, 5, 6}, -1, 2);
  const ShellMesh patch = shell_mesh(mesh);
  EXPECT_EQ(patch.triangles.size(), 1u);
  EXPECT_EQ(patch.groups[0].nodes.size(), 3u);
  EXPECT_EQ(patch.messages, Messages{"sample.msh: the shell is its 1 surface cells; its 1 volume cells are left out"});
}

TEST(ShellFromSurface, QuadraticTrianglesGiveTheirCorners) {
  Mesh mesh =
      mesh_of(CellType::triangle,
              {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0.5, -0.1, 0}}, {{0.6, 0.6, 0}}, {{0, 0.5, 0}}}, {0, 1, 2});
  mesh.blocks[0].mid_nodes_per_cell = 3;
  mesh.blocks[0].mid_nodes = {3, 4, 5};
  const ShellMesh shell = shell_mesh(mesh);
  EXPECT_EQ(shell.nodes.size(), 3u);
  EXPECT_EQ(shell.messages, Messages{"sample.msh: its cells are quadratic; only their corners are used"});
}

/// The same tetrahedron in each format.
class ShellFromFile : public testing::Test {
 protected:
  void expect_tetrahedron(const std::string& name, const std::string& text) const {
    SCOPED_TRACE(name);
    const ShellMesh shell = shell_mesh(io::read_mesh(folder_.write(name, text)));
    EXPECT_EQ(shell.nodes.size(), 4u);
    EXPECT_EQ(shell.triangles.size(), 4u);
    EXPECT_NEAR(enclosed_volume(shell), 1.0 / 6, 1e-7);
  }
  samples::TemporaryDirectory folder_;
};

TEST_F(ShellFromFile, OfEveryFormat) {
  expect_tetrahedron("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  expect_tetrahedron("a.ply",
                     "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
                     "z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 "
                     "1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  const auto facet = [](const char* a, const char* b, const char* c) {
    return std::string("facet normal 0 0 0\nouter loop\nvertex ") + a + "\nvertex " + b + "\nvertex " + c +
           "\nendloop\nendfacet\n";
  };
  expect_tetrahedron("a.stl", "solid a\n" + facet("0 0 0", "0 1 0", "1 0 0") + facet("0 0 0", "1 0 0", "0 0 1") +
                                  facet("1 0 0", "0 1 0", "0 0 1") + facet("0 0 0", "0 0 1", "0 1 0") + "endsolid a\n");
  expect_tetrahedron("a.vtk",
                     "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 "
                     "1\nPOLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  expect_tetrahedron("a.msh",
                     "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 "
                     "1\n$EndNodes\n$Elements\n4\n1 2 2 0 1 1 3 2\n2 2 2 0 1 1 2 4\n3 2 2 0 1 2 3 4\n4 2 2 0 1 1 4 "
                     "3\n$EndElements\n");
  expect_tetrahedron(
      "a.vtu",
      "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid><Piece "
      "NumberOfPoints=\"4\" NumberOfCells=\"4\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" "
      "format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells><DataArray type=\"Int64\" "
      "Name=\"connectivity\" format=\"ascii\">0 2 1 0 1 3 1 2 3 0 3 2</DataArray><DataArray type=\"Int64\" "
      "Name=\"offsets\" format=\"ascii\">3 6 9 12</DataArray><DataArray type=\"UInt8\" Name=\"types\" "
      "format=\"ascii\">5 5 5 5</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>\n");
}

struct Organ {
  const char* file;
  std::size_t nodes, triangles;
};

class ShellOfAnOrgan : public testing::TestWithParam<Organ> {};

TEST_P(ShellOfAnOrgan, IsClosedAndOutward) {
  const std::filesystem::path file = fascia::test::shared_dir() / "meshes" / GetParam().file;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "absent: " << file;
  const ShellMesh shell = shell_mesh(io::read_mesh(file));
  EXPECT_EQ(shell.nodes.size(), GetParam().nodes);
  EXPECT_EQ(shell.triangles.size(), GetParam().triangles);
  EXPECT_EQ(openness(shell), "");
  EXPECT_GT(enclosed_volume(shell), 0);
  std::printf("%s\n", shell_quality(shell).sentence.c_str());
}

INSTANTIATE_TEST_SUITE_P(Files, ShellOfAnOrgan,
                         testing::Values(Organ{"liver_sofa_surface.obj", 2194, 4384},
                                         Organ{"liver_c_v22.msh", 337, 670}, Organ{"liver_m_v41.msh", 680, 1356},
                                         Organ{"liver_sofa_181.msh", 140, 276}),
                         [](const auto& test) {
                           std::string name = test.param.file;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

}  // namespace
}  // namespace fascia::from_surface_test
