#include "core/base/index.hpp"
#include "shells/shell_mesh.hpp"
#include "shells/surface_checks.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <utility>

// Surfaces that no shell can be made of: the file's own numbers, the place, and what would be right.
namespace fascia::from_surface_errors_test {
namespace {

using samples::mesh_of;

std::string error_of(const Mesh& mesh) {
  return samples::input_error([&] { shell_mesh(mesh); });
}

const std::vector<Vec3d> kPoints{{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0}}, {{0, 1, 0}}, {{0.5, 0, 1}}};

TEST(ShellFromSurfaceErrors, ThreeTrianglesAtAnEdge) {
  EXPECT_EQ(error_of(mesh_of(CellType::triangle, kPoints, {0, 1, 2, 1, 0, 4, 0, 1, 3})),
            "sample.msh: triangles 1, 2 and 3 share the edge between nodes 1 and 2, at (0.5, 0, 0); an edge of a shell "
            "must belong to one triangle or two: remove what overlaps, or make the parts that branch off bodies of "
            "their own");
  // A wall within a box: four edges.
  const std::vector<int> box{0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7, 0, 2, 6, 4};
  const std::string walls = error_of(mesh_of(CellType::quadrilateral, samples::cube_points(), box));
  EXPECT_NE(walls.find(" such edges)"), std::string::npos) << walls;
}

TEST(ShellFromSurfaceErrors, SheetsThatCross) {
  // Four wings at an edge bound nothing, whichever way they face.
  const std::vector<Vec3d> points{{{0, 0, 0}}, {{0, 0, 1}}, {{1, 0, 0}}, {{-1, 0, 0}}, {{0, 1, 0}}, {{0, -1, 0}}};
  for (const std::vector<int>& nodes :
       {std::vector<int>{0, 1, 2, 1, 0, 3, 0, 1, 4, 1, 0, 5}, std::vector<int>{0, 1, 2, 1, 0, 3, 0, 1, 4, 0, 1, 5}}) {
    const std::string error = error_of(mesh_of(CellType::triangle, points, nodes));
    EXPECT_NE(error.find("triangles 1, 2, 3 and 1 more share the edge between nodes 1 and 2"), std::string::npos)
        << error;
  }
}

TEST(ShellFromSurfaceErrors, WallThatTwoChambersShare) {
  // Two boxes side by side, both with the wall between them: of a shell it is matter, and no third may meet there.
  std::vector<Vec3d> points = samples::cube_points();
  points.insert(points.end(), {{{2, 0, 0}}, {{2, 1, 0}}, {{2, 0, 1}}, {{2, 1, 1}}});
  Mesh mesh = mesh_of(CellType::quadrilateral, points,
                      {0, 3, 2, 1, 4, 5,  6,  7, 0, 1, 5,  4, 1, 2, 6,  5,  2, 3, 7, 6,  3, 0, 4, 7,
                       1, 2, 9, 8, 5, 10, 11, 6, 1, 8, 10, 5, 8, 9, 11, 10, 9, 2, 6, 11, 2, 1, 5, 6});
  const std::string error = error_of(mesh);
  EXPECT_NE(error.find("make the parts that branch off bodies of their own"), std::string::npos) << error;
}

TEST(ShellFromSurfaceErrors, OneSideOnly) {
  std::vector<Vec3d> points;
  std::vector<int> nodes;
  const int count = 12;
  for (int i = 0; i < count; ++i) {
    const double a = 2 * std::numbers::pi * i / count;
    const Vec3d out{{std::cos(a), std::sin(a), 0}};
    const Vec3d across = out * (0.3 * std::cos(a / 2)) + Vec3d{{0, 0, 0.3 * std::sin(a / 2)}};
    points.push_back(out - across);
    points.push_back(out + across);
  }
  for (int i = 0; i < count; ++i) {
    const bool last = i + 1 == count;
    const int a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    nodes.insert(nodes.end(), {a, b, c, b, d, c});
  }
  const std::string error = error_of(mesh_of(CellType::triangle, points, nodes));
  EXPECT_NE(error.find("sample.msh: a sheet has one side only, as a Moebius strip (at triangle "), std::string::npos)
      << error;
}

TEST(ShellFromSurfaceErrors, FlatTriangles) {
  std::vector<Vec3d> points = kPoints;
  points[2] = {{2, 1e-12, 0}};
  EXPECT_EQ(error_of(mesh_of(CellType::triangle, points, {0, 1, 3, 0, 1, 2})),
            "sample.msh: triangle 2 is flat (its area is below 1e-10 of its longest edge squared); remove it or mesh "
            "again");
  EXPECT_EQ(error_of(mesh_of(CellType::triangle, kPoints, {0, 1, 2, 1, 1, 3})),
            "sample.msh: triangle 2 is flat (its area is below 1e-10 of its longest edge squared); remove it or mesh "
            "again");
  points[2] = points[1];
  EXPECT_EQ(error_of(mesh_of(CellType::triangle, points, {0, 1, 3, 0, 1, 2})),
            "sample.msh: triangle 2 is flat (its area is below 1e-10 of its longest edge squared); remove it or mesh "
            "again")
      << "welding its corners makes it flat";
}

TEST(ShellFromSurfaceErrors, NoNumbersNoExtentNoTriangles) {
  std::vector<Vec3d> points = kPoints;
  points[3][1] = std::nan("");
  const std::string nan = error_of(mesh_of(CellType::triangle, points, {0, 1, 2}));
  EXPECT_NE(nan.find("sample.msh: node 4: coordinate "), std::string::npos) << nan;
  EXPECT_EQ(error_of(mesh_of(CellType::triangle, {{{1, 1, 1}}, {{1, 1, 1}}, {{1, 1, 1}}}, {0, 1, 2})),
            "sample.msh: all its points coincide; give a mesh that has an extent");
  EXPECT_EQ(error_of(mesh_of(CellType::line, kPoints, {0, 1, 1, 2})),
            "sample.msh: has no triangles; a shell needs a surface of triangles or quadrilaterals");
}

TEST(ShellFromSurfaceErrors, AnythingIsRefusedOrSound) {
  std::mt19937 random(7);
  const auto below = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  int sound = 0, refused = 0;
  for (int round = 0; round < 3000; ++round) {
    std::vector<Vec3d> points;
    const int n = 4 + below(8), cells = 1 + below(7);
    for (int i = 0; i < n; ++i) points.push_back({{1.0 * below(3), 1.0 * below(3), 0.5 * below(3)}});
    std::vector<int> nodes;
    const CellType type = below(4) == 0 ? CellType::quadrilateral : CellType::triangle;
    for (int k = 0; k < cells * node_count(type); ++k) nodes.push_back(below(n));
    Mesh mesh = mesh_of(type, points, nodes);
    mesh.groups = {{"some", 1, 2}};
    for (int& group : mesh.blocks[0].group) group = below(2) - 1;
    ShellMesh shell;
    try {
      shell = shell_mesh(mesh);
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find("sample.msh: "), 0u);
      ++refused;
      continue;
    }
    ++sound;
    std::set<std::pair<int, int>> directed;
    for (const auto& t : shell.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_TRUE(directed.insert({t[k], t[(k + 1) % 3]}).second) << "not oriented alike";
    ASSERT_EQ(shell.file_number.size(), shell.triangles.size());
    for (const BodyGroup& group : shell.groups) {
      EXPECT_TRUE(group.nodes.empty() || group.nodes.back() < static_cast<int>(shell.nodes.size()));
      EXPECT_TRUE(group.cells.empty() || group.cells.back() < static_cast<int>(shell.triangles.size()));
    }
    const ShellQuality quality = shell_quality(shell);
    EXPECT_TRUE(std::isfinite(quality.worst_aspect) && quality.area > 0);
    for (const std::string& w : thickness_warnings(shell, std::vector(shell.triangles.size(), 0.7)))
      EXPECT_EQ(w.find("nan"), std::string::npos) << w;
    EXPECT_EQ(closed(shell), openness(shell).empty());
  }
  std::printf("%d sound, %d refused\n", sound, refused);
  EXPECT_GT(sound, 100);
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace fascia::from_surface_errors_test
