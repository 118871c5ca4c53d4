#include "shells/surface_checks.hpp"

#include "core/base/index.hpp"
#include "core/geometry/primitives.hpp"
#include "shells/generate.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace fascia::surface_checks_test {
namespace {

using Messages = std::vector<std::string>;

ShellMesh shell_of(const TriangleMesh& surface) {
  ShellMesh mesh;
  mesh.nodes = surface.points;
  mesh.triangles = surface.triangles;
  return mesh;
}

/// How many triangles are too thick for their curvature.
int too_curved(const ShellMesh& mesh, double thickness) {
  for (const std::string& message : thickness_warnings(mesh, std::vector(mesh.triangles.size(), thickness)))
    if (message.starts_with("the thickness is above the radius of curvature of "))
      return std::stoi(message.substr(std::string("the thickness is above the radius of curvature of ").size()));
  return 0;
}

TEST(ShellChecks, NeedlesAndCapsAreNamed) {
  ShellMesh mesh = rectangle({}, {{1, 0, 0}}, {{0, 1, 0}}, {2, 1}, Diagonal::right);
  EXPECT_EQ(shell_quality(mesh).messages, Messages{});
  EXPECT_NEAR(shell_quality(mesh).worst_aspect, 2.5, 1e-14);  // (1² + ½²) / (1 · ½)
  mesh = rectangle({}, {{50, 0, 0}}, {{0, 1, 0}}, {1, 1}, Diagonal::right);
  mesh.file = "needle.stl";
  mesh.file_number = {7, 8};
  EXPECT_EQ(shell_quality(mesh).messages,
            Messages{"needle.stl: 2 of 2 triangles are needles or caps (longest edge over height above 20; the worst, "
                     "50.02: triangle 7 at (33.33, 0.3333, 0)); they are too stiff and slow the solver down, mesh "
                     "again"});
  mesh = rectangle({}, {{1, 0, 0}}, {{0, 1, 0}}, {1, 1}, Diagonal::right);
  mesh.nodes[2] = {{0.9, 0.05, 0}};  // almost back onto the other triangle
  mesh.nodes[2][2] = 0.001;
  const Messages folded = shell_quality(mesh).messages;
  ASSERT_FALSE(folded.empty());
  EXPECT_NE(folded.back().find("the surface folds back on itself at 1 edge "), std::string::npos) << folded.back();
}

TEST(ShellChecks, PartsAndPinches) {
  ShellMesh mesh;
  mesh.nodes = {{{0, 0, 0}},  {{1, 0, 0}}, {{0, 1, 0}}, {{-1, 0, 0}},
                {{0, -1, 0}}, {{5, 0, 0}}, {{6, 0, 0}}, {{5, 1, 0}}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}, {5, 6, 7}};
  const ShellParts parts = parts_of(mesh);
  EXPECT_EQ(parts.count, 2);
  EXPECT_EQ(parts.pinched, std::vector<int>{0});
  EXPECT_EQ(shell_quality(mesh).messages,
            (Messages{"falls into 2 parts that share no node",
                      "parts of the surface meet in single nodes (1, the first at (0, 0, 0)); they are joined there by "
                      "one frame"}));
  EXPECT_EQ(parts_of(ellipsoid_skin({}, {{1, 1, 1}}, 8)).pinched, std::vector<int>{});
}

TEST(ShellChecks, HolesAreFound) {
  ShellMesh mesh = ellipsoid_skin({}, {{1, 1, 1}}, 16);
  EXPECT_TRUE(closed(mesh));
  EXPECT_EQ(openness(mesh), "");
  // Without the triangles about the node at (0, 0, 1).
  std::erase_if(mesh.triangles, [&](const auto& t) {
    return std::any_of(t.begin(), t.end(), [&](int node) { return mesh.nodes[at(node)][2] > 0.999; });
  });
  const std::vector<ShellHole> found = holes(mesh);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].edges, 4u);
  EXPECT_EQ(found[0].nodes.size(), 4u);
  EXPECT_LT(std::hypot(found[0].middle[0], found[0].middle[1]), 1e-15);
  EXPECT_NEAR(found[0].middle[2], std::cos(std::numbers::pi / 8), 1e-14);
  EXPECT_EQ(openness(mesh).find("is open: it has 1 hole, of 4 edges about ("), 0u) << openness(mesh);
  const ShellMesh tube = cylinder_skin({}, {{0, 0, 3}}, 1, {}, false, {3, 8}, Diagonal::right);
  ASSERT_EQ(holes(tube).size(), 2u);
  EXPECT_EQ(openness(tube).find("is open: it has 2 holes, the longest of 8 edges about (0, 0, 0)"), std::string::npos)
      << "rounding puts the middle about, not at zero: " << openness(tube);
}

TEST(ShellChecks, TheCurvatureOfACylinderAndASphereIsExact) {
  for (const Diagonal diagonal : {Diagonal::right, Diagonal::left, Diagonal::alternating})
    for (const int around : {12, 48}) {
      const ShellMesh tube = cylinder_skin({}, {{0, 0, 2}}, 0.5, {}, false, {4, around}, diagonal);
      const int all = static_cast<int>(tube.triangles.size());
      // Chords turn by 2π/n over 2 R sin(π/n): a radius of R sin(π/n) / (π/n).
      const double x = std::numbers::pi / around, radius = 0.5 * std::sin(x) / x;
      EXPECT_EQ(too_curved(tube, radius * (1 + 1e-9)), all);
      EXPECT_EQ(too_curved(tube, radius * (1 - 1e-9)), 0);
    }
  const ShellMesh ball = ellipsoid_skin({}, {{0.5, 0.5, 0.5}}, 32);
  const int all = static_cast<int>(ball.triangles.size());
  EXPECT_GT(too_curved(ball, 0.65), 0.9 * all);
  EXPECT_LT(too_curved(ball, 0.35), 0.1 * all);
  EXPECT_EQ(too_curved(ball, 0.25), 0);
}

TEST(ShellChecks, CreasesAreNoCurvature) {
  const ShellMesh box = shell_of(box_surface({}, {{1, 1, 1}}, 4, 4, 4));
  EXPECT_EQ(too_curved(box, 0.6), 0);
  const ShellMesh drum = cylinder_skin({}, {{0, 0, 2}}, 1, {}, true, {8, 24}, Diagonal::right);
  EXPECT_EQ(too_curved(drum, 0.9), 0) << "the rims of the caps are sharp";
}

TEST(ShellChecks, ThicknessAgainstTheMesh) {
  const ShellMesh plate = rectangle({}, {{1, 0, 0}}, {{0, 1, 0}}, {10, 10}, Diagonal::right);
  std::vector<double> thickness(plate.triangles.size(), 0.1);
  EXPECT_EQ(thickness_warnings(plate, thickness), Messages{});
  thickness[3] = 0.2;
  const Messages coarse = thickness_warnings(plate, thickness);
  ASSERT_EQ(coarse.size(), 1u);
  EXPECT_EQ(coarse[0].find("the thickness is above the length of the edges of 1 of 200 triangles (the worst, 1.757 "
                           "times: triangle 3 at ("),
            0u)
      << coarse[0];
  thickness[3] = 20;
  EXPECT_EQ(thickness_warnings(plate, thickness),
            Messages{"is 20 m thick and 1.414 m across; write lengths with their unit, as \"2 mm\""});
}

}  // namespace
}  // namespace fascia::surface_checks_test
