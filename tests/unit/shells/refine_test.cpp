#include "shells/refine.hpp"

#include "core/base/index.hpp"
#include "shells/generate.hpp"
#include "shells/surface_checks.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <gtest/gtest.h>

#include <set>

// Triangles that are cut into four: shape, neighbours, groups.
namespace fascia::shell_refine_test {
namespace {

using samples::mesh_of;

TEST(ShellRefine, AreaAndEdgesStay) {
  for (const ShellMesh& mesh :
       {rectangle({}, {{2, 0, 0}}, {{0, 1, 0}}, {3, 2}, Diagonal::alternating), ellipsoid_skin({}, {{1, 2, 0.7}}, 8)}) {
    const ShellMesh fine = refined(mesh);
    ASSERT_EQ(fine.triangles.size(), 4 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      double children = 0;
      for (std::size_t k = 0; k < 4; ++k) children += area(fine, 4 * t + k);
      EXPECT_NEAR(children / area(mesh, t), 1, 1e-14);
    }
    EXPECT_EQ(closed(fine), closed(mesh));
    EXPECT_EQ(parts_of(fine).count, 1);
    for (std::size_t h = 0; h < holes(mesh).size(); ++h) EXPECT_EQ(holes(fine)[h].edges, 2 * holes(mesh)[h].edges);
    std::set<std::array<int, 2>> directed;
    for (const auto& t : fine.triangles)
      for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(directed.insert({t[k], t[(k + 1) % 3]}).second) << "turned over";
  }
}

/// A square of two triangles, of which one is a group, and two of its sides are a line that the diagonal closes.
TEST(ShellRefine, GroupsGoWithTheirCells) {
  Mesh file = mesh_of(CellType::triangle, {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0}}, {{0, 1, 0}}}, {0, 1, 2, 0, 2, 3});
  file.groups = {{"lower", 1, 2}, {"rim", 2, 1}};
  file.blocks[0].group = {0, -1};
  file.blocks.push_back({CellType::line, {0, 1, 1, 2}, {1, 1}, {10, 11}});
  ShellMesh mesh = shell_mesh(file);
  for (int level = 1; level <= 3; ++level) {
    mesh = refined(mesh);
    const int n = 1 << level;
    EXPECT_EQ(mesh.groups[0].cells.size(), static_cast<std::size_t>(n * n));
    EXPECT_EQ(mesh.groups[0].nodes.size(), static_cast<std::size_t>((n + 1) * (n + 2) / 2));
    for (const int node : mesh.groups[0].nodes) EXPECT_LE(mesh.nodes[at(node)][1], mesh.nodes[at(node)][0]);
    EXPECT_EQ(mesh.groups[1].nodes.size(), static_cast<std::size_t>(2 * n + 1)) << "the diagonal is no part of the rim";
    for (const int node : mesh.groups[1].nodes)
      EXPECT_TRUE(mesh.nodes[at(node)][1] == 0 || mesh.nodes[at(node)][0] == 1);
  }
  EXPECT_EQ(mesh.file_number.size(), mesh.triangles.size());
}

}  // namespace
}  // namespace fascia::shell_refine_test
