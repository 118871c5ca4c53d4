#include "core/geometry/surface.hpp"
#include "io/mesh/mesh_reader.hpp"
#include "tests/support/paths.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <cmath>

namespace fascia::shared_meshes_test {
namespace {

double sum_of_tetrahedra(const Mesh& mesh) {
  double sum = 0;
  for (const CellBlock& block : mesh.blocks) {
    if (block.type != CellType::tetrahedron) continue;
    for (std::size_t c = 0; c < block.nodes.size(); c += 4) {
      const auto point = [&](std::size_t n) { return mesh.points[static_cast<std::size_t>(block.nodes[c + n])]; };
      sum += dot(point(1) - point(0), cross(point(2) - point(0), point(3) - point(0))) / 6;
    }
  }
  return sum;
}

class SharedMesh : public testing::TestWithParam<const char*> {};

TEST_P(SharedMesh, surface_encloses_the_cells) {
  const std::filesystem::path file = fascia::test::shared_dir() / "meshes" / GetParam();
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "absent: " << file;
  const Mesh mesh = io::read_mesh(file);
  const ClosedSurface s = closed_surface(mesh);
  const double cells = std::abs(sum_of_tetrahedra(mesh));
  if (cells > 0) {
    EXPECT_NEAR(s.volume, cells, 1e-12 * cells);
  }
  EXPECT_GT(s.volume, 0);
  for (const std::string& message : s.messages) RecordProperty("message", message);
  // Euler's formula: a surface without handles.
  EXPECT_EQ(2 * s.mesh.points.size() - s.mesh.triangles.size(), 4u);
}

INSTANTIATE_TEST_SUITE_P(Livers, SharedMesh,
                         testing::Values("liver_c_v22.msh", "liver_c_v41.msh", "liver_m_v22.msh", "liver_m_v41.msh",
                                         "liver_f_v41.msh", "liver_sofa_181.msh", "liver_sofa_507.msh",
                                         "liver_sofa_surface.obj"));

TEST(SharedMeshes, groups_are_the_same_in_both_versions) {
  const std::filesystem::path folder = fascia::test::shared_dir() / "meshes";
  if (!std::filesystem::exists(folder / "liver_c_v22.msh")) GTEST_SKIP() << "absent: " << folder;
  const Mesh old_version = io::read_mesh(folder / "liver_c_v22.msh"), mesh = io::read_mesh(folder / "liver_c_v41.msh");
  for (const Mesh* m : {&old_version, &mesh}) {
    ASSERT_EQ(m->groups.size(), 3u);
    EXPECT_EQ(m->groups[0].name, "hilum");
    EXPECT_EQ(m->groups[0].dimension, 2);
    EXPECT_EQ(m->groups[2].name, "liver");
    EXPECT_EQ(m->points.size(), 499u);
    std::size_t tetrahedra = 0;
    for (const CellBlock& block : m->blocks) {
      if (block.type != CellType::tetrahedron) continue;
      tetrahedra += block.size();
      for (const int group : block.group) EXPECT_EQ(group, 2);
    }
    EXPECT_EQ(tetrahedra, 1904u);
  }
}

}  // namespace
}  // namespace fascia::shared_meshes_test
