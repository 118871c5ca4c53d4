#include "tests/robustness/element_scenes.hpp"

#include <cmath>

namespace fascia::bad_shells_test {

// Shells: surfaces and scenes that none can be made of. One line that names the file's own cell and the place; status
// 2, nothing written.
namespace {

using namespace fascia::test;

constexpr const char* kWall = R"([materials.soft]
young   = "100 kPa"
poisson = 0.3

[bodies.wall]
model     = "shell"
domain    = { rectangle = { origin = [0, 0, 0], edge_u = [2, 0, 0], edge_v = [0, 1, 0], cells = [4, 2] } }
thickness = "1 cm"
density   = 1000
material  = "soft"

[[constraints]]
body  = "wall"
where = { box = { min = [-0.01, -1, -1], max = [0.01, 2, 1] } }
fix   = "all"

[solver]
kind = "static"
)";

constexpr const char* kRectangle =
    "rectangle = { origin = [0, 0, 0], edge_u = [2, 0, 0], edge_v = [0, 1, 0], cells = [4, 2] }";

/// A sheet of 2 × 2 squares, each as two triangles: cells 1 to 8, nodes 1 to 9; the first two are group "hilum".
FileMesh sheet() {
  FileMesh mesh;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) mesh.nodes.push_back({1.0 * i, 1.0 * j, 0});
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const int a = i + 3 * j, group = a == 0 ? 1 : 2;
      mesh.cells.push_back({FileMesh::triangle, group, {a, a + 1, a + 4}});
      mesh.cells.push_back({FileMesh::triangle, group, {a, a + 4, a + 3}});
    }
  mesh.names = "2 1 \"hilum\"\n2 2 \"free\"\n";
  return mesh;
}

class BadShells : public SceneRuns {
 protected:
  void expect_file_refused(const std::string& name, const std::string& content, std::vector<std::string> blamed) const {
    SCOPED_TRACE(name);
    write(name, content);
    blamed.insert(blamed.end(), {"bodies.wall.domain", name});
    expect_refused(with(kWall, kRectangle, "file = \"" + name + "\""), blamed);
  }
};

TEST_F(BadShells, EdgesOfThreeTriangles) {
  FileMesh mesh = sheet();
  mesh.nodes.push_back({1, 0.5, 1});
  mesh.cells.push_back({FileMesh::triangle, 2, {1, 4, 9}});  // stands on the edge between nodes 2 and 5
  expect_file_refused("wall.msh", mesh.text(),
                      {"triangles 1, 4 and 9 share the edge between nodes 2 and 5, at (1, 0.5, 0)"});
}

TEST_F(BadShells, OneSideOnly) {
  std::string strip;
  const int count = 16;
  for (int i = 0; i < count; ++i) {
    const double a = 2 * M_PI * i / count;
    for (const double s : {-0.3, 0.3}) {
      const double r = 1 + s * std::cos(a / 2);
      strip += "v " + std::to_string(r * std::cos(a)) + " " + std::to_string(r * std::sin(a)) + " " +
               std::to_string(s * std::sin(a / 2)) + "\n";
    }
  }
  for (int i = 0; i < count; ++i) {
    const bool last = i + 1 == count;
    const int a = 2 * i + 1, b = a + 1, c = last ? 2 : a + 2, d = last ? 1 : a + 3;
    for (const auto& f : {std::array{a, b, c}, std::array{b, d, c}})
      strip += "f " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(f[2]) + "\n";
  }
  expect_file_refused("strip.obj", strip, {"one side only", "at triangle "});
}

TEST_F(BadShells, FlatTriangles) {
  FileMesh mesh = sheet();
  mesh.nodes[4] = {0.5, 0, 0};  // onto the lower edge: cell 1 has no height
  expect_file_refused("flat.msh", mesh.text(), {"triangle 1 is flat"});
  mesh = sheet();
  mesh.cells[5].nodes[1] = mesh.cells[5].nodes[0];
  expect_file_refused("twice.msh", mesh.text(), {"triangle 6 is flat"});
}

TEST_F(BadShells, CopyOfATriangleIsLeftOut) {
  FileMesh mesh = sheet();
  mesh.cells.push_back(mesh.cells[2]);
  std::swap(mesh.cells.back().nodes[0], mesh.cells.back().nodes[1]);
  write("repeated.msh", mesh.text());
  write("scene.toml", with(kWall, kRectangle, "file = \"repeated.msh\""));
  const ProgramResult result = fascia({"run", "scene.toml", "--output", "out"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("left out 1 triangle that has the nodes of another (triangle 9, which lies on triangle 3)"),
            std::string::npos)
      << result.err;
}

TEST_F(BadShells, FilesWithoutASurface) {
  FileMesh lines = sheet();
  lines.cells = {{1, 1, {0, 1}}, {1, 1, {1, 2}}};
  expect_file_refused("lines.msh", lines.text(), {"has no triangles; a shell needs a surface"});
  expect_file_refused("points.obj", "v 0 0 0\nv 1 0 0\n", {"has no cells"});
  expect_file_refused("empty.stl", "solid a\nendsolid a\n", {});
  expect_file_refused("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", {});
  expect_file_refused("inf.ply",
                      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
                      "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\ninf 0 0\n0 1 0\n3 "
                      "0 1 2\n",
                      {});
  expect_file_refused("node.msh", with(sheet().text(), "\n1 2 2 1 1 1 2 5\n", "\n1 2 2 1 1 1 2 50\n"), {"50"});
}

TEST_F(BadShells, FilesThatAreAbsent) {
  write("scene.toml", with(kWall, kRectangle, "file = \"absent.stl\""));
  const ProgramResult result = fascia({"check", "scene.toml"});
  EXPECT_EQ(result.status, 4) << result.err;
  EXPECT_NE(result.err.find("absent.stl"), std::string::npos) << result.err;
}

TEST_F(BadShells, RegionsThatSelectNothing) {
  write("wall.msh", sheet().text());
  const auto scene = [](const std::string& thickness) {
    return with(with(kWall, kRectangle, "file = \"wall.msh\""), "\"1 cm\"", thickness);
  };
  expect_refused(scene("[{ where = { box = { min = [5, 5, 5], max = [6, 6, 6] } }, value = 1 }, { value = 0.01 }]"),
                 {"bodies.wall.thickness[0].where", "the region holds no triangle's centre"});
  expect_refused(scene("[{ where = { group = \"hilun\" }, value = 1 }, { value = 0.01 }]"),
                 {"bodies.wall.thickness[0].where", "no group \"hilun\"; it has \"hilum\", \"free\""});
  expect_refused(scene("[{ where = { group = \"hilum\" }, value = 0.01 }]"),
                 {"bodies.wall.thickness[0].where", "no thickness for triangle 3 at (1.667, 0.3333, 0)"});
  expect_refused(scene("[{ where = { boundary = true }, value = 0.02 }, { value = 0.01 }]"),
                 {"bodies.wall.thickness[0].where", "boundary cannot be asked for"});
  expect_refused(with(kWall, "material  = \"soft\"",
                      "material = [{ where = { halfspace = { point = [-1, 0, 0], normal = [1, 0, 0] } }, use = "
                      "\"soft\" }, { use = \"soft\" }]"),
                 {"bodies.wall.material[0].where", "the region holds no triangle's centre"});
}

TEST_F(BadShells, ValuesOfTheScene) {
  expect_refused(with(kWall, "\"1 cm\"", "0"), {"bodies.wall.thickness", "0 is out of range"});
  expect_refused(with(kWall, "\"1 cm\"", "nan"), {"bodies.wall.thickness", "nan is not finite"});
  expect_refused(with(kWall, "thickness = \"1 cm\"", ""),
                 {"bodies.wall.thickness", "is missing for model = \"shell\""});
  expect_refused(with(kWall, ", cells = [4, 2]", ""), {"bodies.wall.domain.rectangle.cells", "is missing"});
  expect_refused(with(kWall, "poisson = 0.3", "poisson = 0.3\nlaw = \"neo-hookean\""),
                 {"bodies.wall.material", "which shells do not take"});
  expect_refused(with(kWall, "edge_v = [0, 1, 0]", "edge_v = [1, 0, 0]"),
                 {"bodies.wall.domain.rectangle.edge_v", "parallel"});
  expect_refused(with(kWall, "density ", "transform = { translate = [1e18, 0, 0] }\ndensity "),
                 {"bodies.wall.domain", "rounding changes the area"});
}

TEST_F(BadShells, TooManyCells) {
  expect_refused(with(kWall, "cells = [4, 2]", "cells = [10000, 10000]"),
                 {"bodies.wall.domain.rectangle.cells", "asks for about 1e+08 cells"});
}

}  // namespace

}  // namespace fascia::bad_shells_test
