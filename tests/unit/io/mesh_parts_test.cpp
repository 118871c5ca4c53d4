#include "core/geometry/mesh_parts.hpp"

#include "core/base/index.hpp"
#include "core/geometry/primitives.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

namespace fascia::mesh_parts_test {
namespace {

using samples::cube_points;
using samples::input_error;
using samples::mesh_of;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Adds cells, numbered on from those that the mesh has.
void add_cells(Mesh& mesh, CellType type, std::vector<int> nodes) {
  std::size_t number = 0;
  for (const CellBlock& block : mesh.blocks) number += block.size();
  CellBlock block{type, std::move(nodes), {}, {}};
  block.group.assign(block.size(), -1);
  for (std::size_t c = 0; c < block.size(); ++c) block.file_number.push_back(static_cast<std::int64_t>(++number));
  mesh.blocks.push_back(std::move(block));
}

void add_point(Mesh& mesh, const Vec3d& x) {
  mesh.points.push_back(x);
  mesh.point_file_number.push_back(static_cast<std::int64_t>(mesh.points.size()));
}

/// A curved sheet of 2 n² triangles over the unit square.
TriangleMesh curved_sheet(int n) {
  TriangleMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = 1.0 * i / n, y = 1.0 * j / n;
      mesh.points.push_back({{x, y, std::sin(4 * x) * std::cos(3 * y)}});
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = i + (n + 1) * j, b = a + n + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  return mesh;
}

/// Edges of two triangles that both run along in the same direction.
int disagreements(const TriangleMesh& mesh) {
  std::map<std::array<int, 2>, std::vector<bool>> directions;
  for (const auto& t : mesh.triangles)
    for (std::size_t n = 0; n < 3; ++n) {
      const int a = t[n], b = t[(n + 1) % 3];
      directions[{std::min(a, b), std::max(a, b)}].push_back(a < b);
    }
  int count = 0;
  for (const auto& [edge, d] : directions) count += d.size() == 2 && d[0] == d[1] ? 1 : 0;
  return count;
}

double volume_of(const TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.triangles)
    volume += dot(mesh.points[at(t[0])], cross(mesh.points[at(t[1])], mesh.points[at(t[2])])) / 6;
  return volume;
}

TEST(MeshParts, solid_sheet_and_line_share_coordinates) {
  // A cube, a sheet on its edge from x = 1 to 2 and a line from the sheet's corner; each on points of its own.
  Mesh mesh = mesh_of(CellType::hexahedron, cube_points(), {0, 1, 2, 3, 4, 5, 6, 7});
  for (const Vec3d& x : {Vec3d{{1 + 1e-10, 0, 1}}, Vec3d{{2, 0, 1}}, Vec3d{{2, 1, 1}}, Vec3d{{1, 1 - 1e-10, 1}},
                         Vec3d{{2, 1, 1 + 2e-10}}, Vec3d{{3, 1, 1}}, Vec3d{{7, 7, 7}}})
    add_point(mesh, x);
  add_cells(mesh, CellType::quadrilateral, {8, 9, 10, 11});
  add_cells(mesh, CellType::line, {12, 13});
  const MeshParts parts = mesh_parts(mesh);

  ASSERT_TRUE(parts.solid);
  EXPECT_NEAR(parts.solid->volume, 1, 1e-15);
  EXPECT_EQ(parts.solid->mesh.points.size(), 8u);
  EXPECT_EQ(parts.sheet.triangles.size(), 2u);
  const std::vector<Vec3d> corners{{{1, 0, 1}}, {{1, 1, 1}}, {{2, 0, 1}}, {{2, 1, 1}}};
  ASSERT_EQ(parts.sheet.points.size(), 4u);
  for (const Vec3d& x : corners)
    EXPECT_EQ(std::count(parts.sheet.points.begin(), parts.sheet.points.end(), x), 1) << x[0] << " " << x[1];
  EXPECT_EQ(parts.line_points, (std::vector<Vec3d>{{{2, 1, 1}}, {{3, 1, 1}}}));
  EXPECT_EQ(parts.segments, (std::vector<std::array<int, 2>>{{0, 1}}));
  ASSERT_EQ(parts.messages.size(), 2u);
  EXPECT_EQ(parts.messages[0], "sample.msh: left out 1 points that no cell uses (the first: node 15)");
  EXPECT_EQ(parts.messages[1], "sample.msh: welded 3 points that coincide with others");
}

TEST(MeshParts, solid_is_that_of_closed_surface) {
  const Mesh mesh = mesh_of(CellType::wedge, cube_points(), {0, 2, 1, 4, 6, 5, 0, 3, 2, 4, 7, 6});
  const MeshParts parts = mesh_parts(mesh);
  const ClosedSurface closed = closed_surface(mesh);
  ASSERT_TRUE(parts.solid);
  EXPECT_EQ(parts.solid->volume, closed.volume);
  EXPECT_EQ(parts.solid->mesh.points, closed.mesh.points);
  EXPECT_EQ(parts.solid->mesh.triangles, closed.mesh.triangles);
  EXPECT_EQ(parts.messages, closed.messages);
  EXPECT_TRUE(parts.sheet.triangles.empty() && parts.segments.empty());
}

TEST(MeshParts, faces_of_volume_cells_are_no_sheet) {
  // Two wedges: a quadrilateral of the boundary, one between the cells, half of another, and a triangle.
  Mesh mesh = mesh_of(CellType::wedge, cube_points(), {0, 1, 2, 4, 5, 6, 0, 2, 3, 4, 6, 7});
  add_cells(mesh, CellType::quadrilateral, {1, 0, 4, 5, 0, 2, 6, 4});
  add_cells(mesh, CellType::triangle, {1, 2, 6, 0, 2, 1, 3, 6, 7});
  EXPECT_TRUE(mesh_parts(mesh).sheet.triangles.empty());
  add_cells(mesh, CellType::triangle, {1, 3, 4});
  EXPECT_EQ(mesh_parts(mesh).sheet.triangles.size(), 1u);
}

TEST(MeshParts, quadrilateral_on_two_faces_is_no_sheet) {
  const std::vector<int> tetrahedra{0, 1, 2, 4, 0, 2, 3, 4};
  for (int start = 0; start < 4; ++start) {
    Mesh mesh = mesh_of(CellType::tetrahedron, cube_points(), tetrahedra);
    add_cells(mesh, CellType::quadrilateral, {start, (start + 1) % 4, (start + 2) % 4, (start + 3) % 4});
    EXPECT_TRUE(mesh_parts(mesh).sheet.triangles.empty()) << start;
  }
}

TEST(MeshParts, open_sheet_is_oriented_by_fewest_turns) {
  TriangleMesh sheet = curved_sheet(12);
  const TriangleMesh right = sheet;
  EXPECT_TRUE(mesh_parts(mesh_of(sheet)).messages.empty());
  for (const std::size_t t : {5u, 17u, 18u, 200u}) std::swap(sheet.triangles[t][0], sheet.triangles[t][1]);
  const MeshParts parts = mesh_parts(mesh_of(sheet));
  EXPECT_EQ(disagreements(parts.sheet), 0);
  ASSERT_EQ(parts.messages.size(), 1u);
  EXPECT_EQ(parts.messages[0],
            "sample.msh: turned over 4 of 288 triangles of sheets that disagreed with their neighbours (the first: "
            "triangle 6)");
  for (std::size_t t = 0; t < right.triangles.size(); ++t) {
    const auto& a = parts.sheet.triangles[t];
    const auto& b = right.triangles[t];
    const auto start = static_cast<std::size_t>(std::find(b.begin(), b.end(), a[0]) - b.begin());
    EXPECT_EQ(a[1], b[(start + 1) % 3]) << t;
  }
}

TEST(MeshParts, any_turns_are_undone) {
  std::mt19937 random(7);
  const std::vector<TriangleMesh> samples{curved_sheet(9), ellipsoid_surface({{1, 2, 3}}, {{1, 2, 0.5}}, 5)};
  for (int trial = 0; trial < 40; ++trial)
    for (const TriangleMesh& sample : samples) {
      TriangleMesh sheet = sample;
      for (auto& t : sheet.triangles)
        if (random() % 2 == 0) std::swap(t[1], t[2]);
      const MeshParts parts = mesh_parts(mesh_of(sheet));
      EXPECT_EQ(disagreements(parts.sheet), 0);
      EXPECT_EQ(parts.sheet.points, sample.points);
      const bool closed = &sample == &samples[1];
      EXPECT_NEAR(closed ? volume_of(parts.sheet) : 0, closed ? volume_of(sample) : 0, 1e-12);
    }
}

TEST(MeshParts, closed_sheets_face_outward) {
  TriangleMesh two = box_surface({{0, 0, 0}}, {{1, 1, 1}}, 2, 2, 2);
  const TriangleMesh other = box_surface({{3, 0, 0}}, {{5, 2, 2}}, 2, 2, 2);
  const int shift = static_cast<int>(two.points.size());
  two.points.insert(two.points.end(), other.points.begin(), other.points.end());
  for (const auto& t : other.triangles) two.triangles.push_back({t[0] + shift, t[2] + shift, t[1] + shift});
  const MeshParts parts = mesh_parts(mesh_of(two));
  EXPECT_FALSE(parts.solid);
  EXPECT_NEAR(volume_of(parts.sheet), 9, 1e-13);
  EXPECT_EQ(parts.messages, (std::vector<std::string>{"sample.msh: turned over 1 closed sheets that faced inward"}));
}

TEST(MeshParts, branched_sheet) {
  // Three squares at the edge between points 0 and 1; in the second one the halves disagree.
  const std::vector<Vec3d> points{{{0, 0, 0}}, {{0, 0, 1}}, {{1, 0, 0}},   {{1, 0, 1}},
                                  {{0, 1, 0}}, {{0, 1, 1}}, {{-1, -1, 0}}, {{-1, -1, 1}}};
  const MeshParts parts =
      mesh_parts(mesh_of(CellType::triangle, points, {0, 2, 3, 0, 3, 1, 0, 4, 5, 0, 1, 5, 0, 7, 6, 0, 1, 7}));
  EXPECT_EQ(parts.sheet.triangles.size(), 6u);
  EXPECT_EQ(disagreements(parts.sheet), 0);
  ASSERT_EQ(parts.messages.size(), 1u);
  EXPECT_TRUE(contains(parts.messages[0], "turned over 1 of 6 triangles")) << parts.messages[0];
}

TEST(MeshParts, moebius_strip) {
  const int n = 12;
  std::vector<Vec3d> points;
  std::vector<int> nodes;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * 3.14159265358979 * i / n;
    for (const double w : {-0.3, 0.3})
      points.push_back(
          {{(1 + w * std::cos(a / 2)) * std::cos(a), (1 + w * std::cos(a / 2)) * std::sin(a), w * std::sin(a / 2)}});
    const bool last = i == n - 1;
    nodes.insert(nodes.end(), {2 * i, last ? 1 : 2 * i + 2, last ? 0 : 2 * i + 3, 2 * i + 1});
  }
  const std::string e = input_error([&] { mesh_parts(mesh_of(CellType::quadrilateral, points, nodes)); });
  EXPECT_TRUE(contains(e, "sample.msh: a sheet has one side only, as a Moebius strip (at triangle ")) << e;
  nodes.resize(nodes.size() - 4);
  EXPECT_EQ(disagreements(mesh_parts(mesh_of(CellType::quadrilateral, points, nodes)).sheet), 0);
}

TEST(MeshParts, lines_without_length_and_repeated_ones_are_left_out) {
  std::vector<Vec3d> points = cube_points();
  points.push_back({{1, 1e-10, 0}});
  const MeshParts parts = mesh_parts(mesh_of(CellType::line, points, {5, 6, 1, 8, 3, 3, 6, 5, 6, 7, 8, 0, 0, 1}));
  EXPECT_FALSE(parts.solid);
  EXPECT_EQ(parts.line_points, (std::vector<Vec3d>{{{0, 0, 0}}, {{1, 0, 0}}, {{1, 0, 1}}, {{1, 1, 1}}, {{0, 1, 1}}}));
  EXPECT_EQ(parts.segments, (std::vector<std::array<int, 2>>{{2, 3}, {3, 4}, {1, 0}}));
  ASSERT_EQ(parts.messages.size(), 4u);
  EXPECT_EQ(parts.messages[2], "sample.msh: left out 2 line cells of zero length (the first: cell 2)");
  EXPECT_EQ(parts.messages[3], "sample.msh: left out 2 line cells that repeat others (the first: cell 4)");
}

TEST(MeshParts, unusable_cells_are_named) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    std::vector<Vec3d> points = cube_points();
    points[6][1] = bad;
    const std::string e = input_error([&] { mesh_parts(mesh_of(CellType::line, points, {0, 1})); });
    EXPECT_TRUE(contains(e, "sample.msh: node 7: coordinate")) << e;
  }
  Mesh mesh = mesh_of(curved_sheet(2));
  add_cells(mesh, CellType::triangle, {0, 1, 1});
  EXPECT_TRUE(contains(input_error([&] { mesh_parts(mesh); }), "triangle 9 is flat"));
  mesh.blocks.back().nodes = {4, 1, 0};
  const MeshParts parts = mesh_parts(mesh);
  EXPECT_EQ(parts.sheet.triangles.size(), 8u);
  ASSERT_EQ(parts.messages.size(), 1u);
  EXPECT_TRUE(contains(parts.messages[0],
                       "left out 1 triangle that has the nodes of another (triangle 9, which lies on "
                       "triangle 1)"));
  mesh.groups = {{"a", 1, 2}};
  mesh.blocks.back().group = {0};
  EXPECT_EQ(mesh_parts(mesh).sheet.triangles.size(), 8u);
  const std::string e = input_error([&] { mesh_parts(mesh_of(CellType::tetrahedron, cube_points(), {0, 1, 2, 3})); });
  EXPECT_TRUE(contains(e, "cell 1 is flat")) << e;
}

TEST(MeshParts, nothing_to_use) {
  for (const CellType type : {CellType::vertex, CellType::line, CellType::triangle}) {
    const std::string e = input_error([&] { mesh_parts(mesh_of(type, cube_points(), {})); });
    EXPECT_TRUE(contains(e, "sample.msh: has neither volume cells, triangles nor lines; give a mesh")) << e;
  }
  EXPECT_TRUE(contains(input_error([] { mesh_parts(mesh_of(CellType::vertex, cube_points(), {0})); }), "neither"));
  EXPECT_TRUE(contains(input_error([] { mesh_parts(mesh_of(CellType::line, cube_points(), {1, 1})); }), "coincide"));
  const Mesh mesh = mesh_of(CellType::line, cube_points(), {1, 1, 2, 2});
  EXPECT_TRUE(contains(input_error([&] { mesh_parts(mesh); }), "all its lines have zero length"));
}

}  // namespace
}  // namespace fascia::mesh_parts_test
