#include "assembly/bodies/shell_meshes.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "shells/surface_checks.hpp"
#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

#include <unistd.h>

// From the scene's body to its triangles, their thickness and material.
namespace fascia::app::shell_meshes_test {
namespace {

using test::shell_body;

constexpr std::string_view square =
    "rectangle = { origin = [0, 0, 0], edge_u = [2, 0, 0], edge_v = [0, 1, 0], cells = [4, 2] }";

Body body_of(std::string_view domain, std::string_view more = "thickness = \"2 mm\"\n") {
  return test::parse(shell_body(domain, more)).bodies.at(0);
}

/// What a scene error says.
template <class Act>
std::string error_of(const Act& act) {
  try {
    act();
    return "";
  } catch (const SceneError& error) {
    return error.what();
  }
}

std::string thickness_error(std::string_view domain, std::string_view thickness) {
  const Body body = body_of(domain, "thickness = " + std::string(thickness) + "\n");
  const ShellMesh mesh = shell_mesh_of(body);
  return error_of([&] { shell_thickness(body, mesh); });
}

TEST(ShellMeshes, OfEveryDomain) {
  EXPECT_EQ(shell_mesh_of(body_of(square)).triangles.size(), 16u);
  const auto triangles = [](const std::string& domain) { return shell_mesh_of(body_of(domain)).triangles.size(); };
  const std::string tube = "cylinder = { from = [0, 0, 0], to = [0, 0, 3], radius = 1, cells = [3, 7], ";
  EXPECT_EQ(triangles(tube + "caps = false }"), 42u);
  EXPECT_EQ(triangles(tube + "closed = false }"), 42u);
  EXPECT_EQ(triangles(tube + "caps = true }"), 42u + 2 * 7);
  EXPECT_EQ(triangles("sphere = { center = [0, 0, 0], radius = 1, cells = [8] }"), 32u);
  EXPECT_EQ(triangles("annulus = { center = [0, 0, 0], normal = [0, 0, 1], inner = 1, outer = 2, cells = [2, 9] }"),
            36u);
  const ShellMesh slit = shell_mesh_of(body_of(
      "annulus = { center = [0, 0, 0], normal = [0, 0, 1], inner = 6, outer = 10, cells = [6, 30], angle = [\"0 "
      "degree\", \"360 degree\"], closed = false }"));
  EXPECT_EQ(slit.nodes.size(), 7u * 31);
  const auto first = [](const char* diagonal) {
    const std::string domain = std::string(square.substr(0, square.size() - 1)) + ", diagonal = \"" + diagonal + "\" }";
    return shell_mesh_of(body_of(domain)).triangles[2][2];
  };
  EXPECT_EQ(first("right"), 7);
  EXPECT_EQ(first("left"), 6);
  EXPECT_EQ(first("alternating"), 6);
}

TEST(ShellMeshes, ArePlaced) {
  const Body body = body_of(square,
                            "thickness = 0.1\ntransform = { scale = 0.5, rotate = { axis = [0, 0, 3], angle = \"90 "
                            "degree\" }, translate = [1, 2, 3] }\n");
  const ShellMesh mesh = shell_mesh_of(body);
  EXPECT_LT(norm(mesh.nodes[0] - Vec3d{{1, 2, 3}}), 1e-15);
  EXPECT_LT(norm(mesh.nodes[4] - Vec3d{{1, 3, 3}}), 1e-15) << "along x, halved, then along y";
  EXPECT_NEAR(area(mesh), 0.5, 1e-15);
  const Vec3d u = mesh.nodes[1] - mesh.nodes[0], v = mesh.nodes[5] - mesh.nodes[0];
  EXPECT_GT(cross(u, v)[2], 0) << "no mirroring";
  const Body far = body_of(square, "thickness = 0.1\ntransform = { translate = [1e17, 0, 0] }\n");
  EXPECT_THROW(shell_mesh_of(far), InputError);
}

TEST(ShellMeshes, ThicknessByRegion) {
  const Body body = body_of(square,
                            "thickness = [{ where = { halfspace = { point = [1, 0, 0], normal = [1, 0, 0] } }, value = "
                            "0.02 }, { value = 0.01 }]\n");
  const ShellMesh mesh = shell_mesh_of(body);
  const std::vector<double> thickness = shell_thickness(body, mesh);
  ASSERT_EQ(thickness.size(), 16u);
  for (std::size_t t = 0; t < thickness.size(); ++t)
    EXPECT_EQ(thickness[t], middle(mesh, t)[0] < 1 ? 0.02 : 0.01) << "the first that matches";
}

TEST(ShellMeshes, ThicknessErrors) {
  EXPECT_EQ(thickness_error(square,
                            "[{ where = { sphere = { center = [9, 9, 9], radius = 1 } }, value = 1 }, { value "
                            "= 2 }]"),
            "a.toml:7:24: bodies.skin.thickness[0].where: the region holds no triangle's centre; enlarge it");
  EXPECT_EQ(thickness_error(square, "[{ where = \"all\", value = 1 }, { value = 2 }]"),
            "a.toml:7:44: bodies.skin.thickness[1].where: entries before it hold all triangles of the region; remove "
            "it or put it before them");
  EXPECT_EQ(thickness_error(square, "[{ where = { box = { min = [0, 0, 0], max = [1, 1, 1] } }, value = 1 }]"),
            "a.toml:7:24: bodies.skin.thickness[0].where: no thickness for triangle 4 at (1.333, 0.1667, 0); let the "
            "last entry of thickness have no where");
  EXPECT_EQ(thickness_error(square, "[{ where = { group = \"wall\" }, value = 1 }, { value = 2 }]"),
            "a.toml:7:24: bodies.skin.thickness[0].where: the mesh has no group \"wall\"; it has \"u0\", "
            "\"u1\", \"v0\", \"v1\"");
  EXPECT_EQ(thickness_error(square, "[{ where = { ids = [0] }, value = 1 }, { value = 2 }]"),
            "a.toml:7:24: bodies.skin.thickness[0].where: nearest and ids select nodes, not material; use a box, "
            "sphere, cylinder or halfspace");
}

/// A mesh file, gone at the end.
class ShellMeshFile : public testing::Test {
 protected:
  ~ShellMeshFile() override { std::filesystem::remove(path_); }

  Body body(const std::string& text, const std::string& more) const {
    std::ofstream(path_) << text;
    return body_of("file = \"" + path_.string() + "\"", more);
  }
  const std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("fascia-shell-" + std::to_string(getpid()) + ".msh");
};

constexpr const char* kTwoWalls =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 \"thick\"\n2 2 \"thin\"\n1 3 "
    "\"rim\"\n$EndPhysicalNames\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 7 7 7\n$EndNodes\n$Elements\n3\n1 2 "
    "2 "
    "1 1 1 2 3\n2 2 2 2 1 1 3 4\n3 1 2 3 1 1 2\n$EndElements\n";

TEST_F(ShellMeshFile, GroupsSelectTriangles) {
  const Body walls =
      body(kTwoWalls,
           "thickness = [{ where = { group = \"thick\" }, value = 0.02 }, { where = { group = \"thin\" }, "
           "value = 0.01 }]\n");
  const ShellMesh mesh = shell_mesh_of(walls);
  EXPECT_EQ(shell_thickness(walls, mesh), (std::vector<double>{0.02, 0.01}));
  ASSERT_EQ(mesh.messages.size(), 1u);
  EXPECT_NE(mesh.messages[0].find("left out 1 points that no cell uses (the first: node 5)"), std::string::npos);
  const std::vector<const MaterialUse*> materials = shell_materials(walls, mesh);
  ASSERT_EQ(materials.size(), 2u);
  EXPECT_EQ(materials[1], &walls.materials[0]);

  const Body rim = body(kTwoWalls, "thickness = [{ where = { group = \"rim\" }, value = 0.02 }, { value = 1 }]\n");
  const std::string error = error_of([&] { shell_thickness(rim, mesh); });
  EXPECT_EQ(
      error,
      "a.toml:7:24: bodies.skin.thickness[0].where: the group holds no triangle of the shell; groups of triangles "
      "are \"thick\", \"thin\"");
}

TEST_F(ShellMeshFile, NeedlesAreReported) {
  std::string text = kTwoWalls;
  text.replace(text.find("4 0 1 0"), 7, "4 0.01 0.03 0");
  const ShellMesh mesh = shell_mesh_of(body(text, "thickness = 0.001\ntransform = { scale = 2 }\n"));
  ASSERT_EQ(mesh.messages.size(), 2u);
  EXPECT_NE(mesh.messages[1].find("1 of 2 triangles are needles or caps"), std::string::npos) << mesh.messages[1];
  EXPECT_NE(mesh.messages[1].find("triangle 2 at (0.6733, 0.6867, 0)"), std::string::npos) << mesh.messages[1];
}

}  // namespace
}  // namespace fascia::app::shell_meshes_test
