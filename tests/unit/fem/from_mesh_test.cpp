#include "fem/from_mesh.hpp"

#include "fem/locator.hpp"
#include "fem/quality.hpp"
#include "io/mesh/mesh_reader.hpp"
#include "tests/support/paths.hpp"
#include "tests/unit/fem/fem_samples.hpp"

#include <filesystem>

namespace fascia::from_mesh_test {
namespace {

using namespace samples;

Mesh two_boxes(const ElementKind& kind) { return file_of(generate_box({{0, 0, 0}}, {{2, 1, 1}}, {2, 1, 1}, kind)); }

/// Adds a block of cells of one group.
void add_group(Mesh& mesh, const std::string& name, CellType type, const std::vector<int>& nodes,
               std::int64_t first_number) {
  mesh.groups.push_back({name, static_cast<int>(mesh.groups.size()) + 1, dimension_of(type)});
  CellBlock block;
  block.type = type;
  block.nodes = nodes;
  block.group.assign(block.size(), static_cast<int>(mesh.groups.size()) - 1);
  for (std::size_t c = 0; c < block.size(); ++c)
    block.file_number.push_back(first_number + static_cast<std::int64_t>(c));
  mesh.blocks.push_back(block);
}

TEST(FromMesh, elements_keep_the_nodes_and_numbers_of_the_file) {
  for (const ElementKind& kind : {hexahedra, hexahedra_2, tetrahedra, tetrahedra_2}) {
    const ElementMesh box = generate_ellipsoid({{0, 0, 0}}, {{1, 2, 3}}, {8, 1}, kind);
    const ElementMesh made = element_mesh(file_of(box), kind.family, kind.order);
    EXPECT_EQ(made.shape, box.shape);
    EXPECT_EQ(made.nodes, box.nodes);
    EXPECT_EQ(made.element_nodes, box.element_nodes);
    EXPECT_EQ(made.element_number, box.element_number);
    EXPECT_TRUE(made.messages.empty());
  }
}

TEST(FromMesh, linear_files_become_quadratic_with_straight_edges) {
  const ElementMesh made = element_mesh(two_boxes(hexahedra), ElementFamily::hexahedra, 2);
  EXPECT_EQ(made.nodes.size(), 12u + 20);
  EXPECT_NEAR(volume_of(made), 2, 1e-14);
}

TEST(FromMesh, quadratic_files_give_their_corners_for_order_1) {
  const ElementMesh made = element_mesh(two_boxes(tetrahedra_2), ElementFamily::tetrahedra, 1);
  EXPECT_EQ(made.shape, ElementShape::tet4);
  EXPECT_EQ(made.nodes.size(), 12u);
  ASSERT_EQ(made.messages.size(), 1u);
  expect_contains(made.messages[0], "sample.msh: its tetrahedra are quadratic; only their corners are used");
}

TEST(FromMesh, groups_of_all_dimensions) {
  for (const ElementKind& kind : {hexahedra, hexahedra_2}) {
    Mesh mesh = two_boxes(kind);
    // Nodes run x fastest: 0 1 2 / 3 4 5 below, 6 7 8 / 9 10 11 above.
    add_group(mesh, "end", CellType::quadrilateral, {0, 6, 9, 3}, 11);
    add_group(mesh, "edge", CellType::line, {0, 1, 1, 2}, 21);
    add_group(mesh, "tip", CellType::vertex, {11}, 31);
    add_group(mesh, "halves", CellType::triangle, {0, 6, 9}, 41);
    add_group(mesh, "right", CellType::hexahedron, {1, 2, 5, 4, 7, 8, 11, 10}, 2);
    add_group(mesh, "again", CellType::hexahedron, {1, 2, 5, 4, 7, 8, 11, 10}, 2);
    if (kind.order == 2)
      for (std::size_t b : {5u, 6u}) {
        mesh.blocks[b].mid_nodes_per_cell = 12;
        mesh.blocks[b].mid_nodes.assign(mesh.blocks[0].mid_nodes.begin() + 12, mesh.blocks[0].mid_nodes.end());
      }
    const ElementMesh made = element_mesh(mesh, ElementFamily::hexahedra, 2);
    EXPECT_EQ(made.size(), 2u);
    ASSERT_EQ(made.groups.size(), 6u);
    const std::array<std::size_t, 6> count{8, 5, 1, 5, 20, 20};  // a diagonal of a face has no node
    for (std::size_t g = 0; g < 6; ++g) EXPECT_EQ(made.groups[g].nodes.size(), count[g]) << made.groups[g].name;
    for (const int n : made.groups[0].nodes) EXPECT_EQ(made.nodes[at(n)][0], 0);
    for (const int n : made.groups[1].nodes) EXPECT_EQ(made.nodes[at(n)][1] + made.nodes[at(n)][2], 0);
    EXPECT_EQ(made.groups[0].dimension, 2);
    EXPECT_TRUE(made.groups[0].elements.empty());
    EXPECT_EQ(made.groups[4].elements, std::vector<int>{1});
    EXPECT_EQ(made.groups[5].elements, std::vector<int>{1});
    const ElementMesh linear = element_mesh(mesh, ElementFamily::hexahedra, 1);
    EXPECT_EQ(linear.groups[0].nodes, (std::vector<int>{0, 3, 6, 9}));
  }
}

TEST(FromMesh, inverted_meshes_are_turned_over) {
  for (const ElementKind& kind : {hexahedra, hexahedra_2, tetrahedra, tetrahedra_2}) {
    Mesh mesh = file_of(generate_ellipsoid({{0, 0, 0}}, {{1, 2, 3}}, {8, 1}, kind));
    const double volume = volume_of(element_mesh(mesh, kind.family, kind.order));
    for (Vec3d& X : mesh.points) X[0] = -X[0];
    const ElementMesh made = element_mesh(mesh, kind.family, kind.order);
    EXPECT_NEAR(volume_of(made), volume, 1e-12);
    ASSERT_EQ(made.messages.size(), 1u);
    expect_contains(made.messages[0], "elements are turned the wrong way round; turned over");
  }
}

TEST(FromMesh, oddities_leave_messages) {
  Mesh mesh = two_boxes(hexahedra);
  const Mesh apart = file_of(generate_box({{2, 1, 1}}, {{3, 2, 2}}, {1, 1, 1}, hexahedra));
  mesh.points.push_back({{9, 9, 9}});
  mesh.point_file_number.push_back(77);
  const int first = static_cast<int>(mesh.points.size());
  for (const Vec3d& X : apart.points) {
    mesh.points.push_back(X);
    mesh.point_file_number.push_back(static_cast<std::int64_t>(mesh.points.size()) + 100);
  }
  for (const int n : apart.blocks[0].nodes) mesh.blocks[0].nodes.push_back(n + first);
  mesh.blocks[0].group.push_back(-1);
  mesh.blocks[0].file_number.push_back(3);
  add_group(mesh, "nothing", CellType::vertex, {12}, 50);
  const ElementMesh made = element_mesh(mesh, ElementFamily::hexahedra, 1);
  EXPECT_EQ(made.nodes.size(), 20u);
  ASSERT_EQ(made.messages.size(), 4u);
  expect_contains(made.messages[0], "falls into 2 parts that share no node");
  expect_contains(made.messages[1], "dropped 1 nodes that no element uses (the first: node 77)");
  expect_contains(made.messages[2], "1 nodes coincide with others (the first: node 114 with node 12)");
  expect_contains(made.messages[3], "group \"nothing\" has no nodes of elements");
}

TEST(FromMesh, parts_that_meet_in_an_edge_leave_a_message) {
  Mesh mesh = file_of(generate_box({{0, 0, 0}}, {{2, 2, 1}}, {2, 2, 1}, hexahedra));
  CellBlock& block = mesh.blocks[0];
  block.nodes.erase(block.nodes.begin() + 8, block.nodes.begin() + 24);  // the first and the last cell stay
  block.group.resize(2);
  block.file_number.resize(2);
  const ElementMesh made = element_mesh(mesh, ElementFamily::hexahedra, 1);
  expect_contains(made.messages.at(0), "2 parts share no face");
}

class LiverElements : public testing::TestWithParam<const char*> {};

TEST_P(LiverElements, volume_quality_and_places) {
  const std::filesystem::path file = fascia::test::shared_dir() / "meshes" / GetParam();
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "absent: " << file;
  const Mesh mesh = io::read_mesh(file);
  const ElementMesh linear = element_mesh(mesh, ElementFamily::tetrahedra, 1);
  const ElementMesh made = element_mesh(mesh, ElementFamily::tetrahedra, 2);
  EXPECT_EQ(linear.size(), 1904u);
  EXPECT_EQ(linear.nodes.size(), 499u);
  EXPECT_EQ(linear.groups.size(), 3u);
  EXPECT_EQ(linear.groups[2].elements.size(), 1904u);
  EXPECT_EQ(linear.groups[2].nodes.size(), 499u);
  EXPECT_EQ(made.groups[2].nodes.size(), made.nodes.size());
  EXPECT_NEAR(volume_of(made), volume_of(linear), 1e-12 * volume_of(linear));
  EXPECT_EQ(mesh_quality(linear).sentence.substr(0, 28), "1904 tetrahedra on 499 nodes");
  const ElementLocator locator(linear);
  for (std::size_t e = 0; e < linear.size(); ++e)
    EXPECT_EQ(locator.locate(shape_at(linear, e, {{0.3, 0.2, 0.1}}).X).element, static_cast<int>(e));
}

INSTANTIATE_TEST_SUITE_P(Livers, LiverElements, testing::Values("liver_c_v22.msh", "liver_c_v41.msh"));

}  // namespace
}  // namespace fascia::from_mesh_test
