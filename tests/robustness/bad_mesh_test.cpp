#include "tests/robustness/scene_runs.hpp"

#include <array>

namespace fascia::bad_mesh_test {

// Mesh files as domains: what is wrong with one is said in one line that names the file; status 2, nothing written.
namespace {

using namespace fascia::test;

constexpr std::array<std::array<double, 3>, 8> kCorners = {
    {{0, 0, 0}, {1, 0, 0}, {1, 0.2, 0}, {0, 0.2, 0}, {0, 0, 0.2}, {1, 0, 0.2}, {1, 0.2, 0.2}, {0, 0.2, 0.2}}};

/// The six tetrahedra around the diagonal from corner 1 to corner 7, counted from one.
constexpr std::array<std::array<int, 4>, 6> kTetrahedra = {
    {{1, 2, 3, 7}, {1, 3, 4, 7}, {1, 4, 8, 7}, {1, 8, 5, 7}, {1, 5, 6, 7}, {1, 6, 2, 7}}};

/// The box of the cantilever as tetrahedra in Gmsh 2.2; those from `first_turned` on are inside out.
std::string gmsh_box(std::size_t first_turned = kTetrahedra.size()) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n";
  for (std::size_t i = 0; i < kCorners.size(); ++i) {
    text += std::to_string(i + 1);
    for (const double x : kCorners[i]) text += " " + std::to_string(x);
    text += "\n";
  }
  text += "$EndNodes\n$Elements\n6\n";
  for (std::size_t c = 0; c < kTetrahedra.size(); ++c) {
    std::array<int, 4> cell = kTetrahedra[c];
    if (c >= first_turned) std::swap(cell[0], cell[1]);
    text += std::to_string(c + 1) + " 4 2 0 1";
    for (const int node : cell) text += " " + std::to_string(node);
    text += "\n";
  }
  return text + "$EndElements\n";
}

/// The same box in VTK's format.
std::string vtk_box() {
  std::string text = "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n";
  for (const auto& corner : kCorners) {
    for (const double x : corner) text += std::to_string(x) + " ";
    text += "\n";
  }
  text += "CELLS 6 30\n";
  for (const auto& cell : kTetrahedra) {
    text += "4";
    for (const int node : cell) text += " " + std::to_string(node - 1);
    text += "\n";
  }
  text += "CELL_TYPES 6\n";
  for (std::size_t c = 0; c < kTetrahedra.size(); ++c) text += "10\n";
  return text;
}

/// The surface of the same box as an OBJ file, without its last `missing` triangles.
std::string obj_box(std::size_t missing = 0) {
  constexpr std::array<std::array<int, 3>, 12> triangles = {{{1, 3, 2},
                                                             {1, 4, 3},
                                                             {5, 6, 7},
                                                             {5, 7, 8},
                                                             {1, 2, 6},
                                                             {1, 6, 5},
                                                             {2, 3, 7},
                                                             {2, 7, 6},
                                                             {3, 4, 8},
                                                             {3, 8, 7},
                                                             {4, 1, 5},
                                                             {4, 5, 8}}};
  std::string text;
  for (const auto& corner : kCorners) {
    text += "v";
    for (const double x : corner) text += " " + std::to_string(x);
    text += "\n";
  }
  for (std::size_t f = 0; f + missing < triangles.size(); ++f) {
    text += "f";
    for (const int vertex : triangles[f]) text += " " + std::to_string(vertex);
    text += "\n";
  }
  return text;
}

class BadMesh : public SceneRuns {
 protected:
  /// The cantilever with the file as its domain.
  void write_scene(const std::string& file) const {
    const std::string box = "{ box = { min = [0, 0, 0], max = [1, 0.2, 0.2] } }";
    write("scene.toml", with(kCantilever, box, "{ file = \"" + file + "\" }"));
  }

  ProgramResult run_with_domain(const std::string& file) const {
    write_scene(file);
    return fascia({"run", "scene.toml", "--output", "out"});
  }

  void expect_refused(const std::string& file, const std::string& content, const std::string& says) const {
    write(file, content);
    const ProgramResult result = run_with_domain(file);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
    EXPECT_NE(result.err.find(file), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << "should say '" << says << "': " << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }
};

TEST_F(BadMesh, GoodOnesRun) {
  write("box.msh", gmsh_box());
  write("box.obj", obj_box());
  for (const char* file : {"box.msh", "box.obj"}) {
    const ProgramResult result = run_with_domain(file);
    ASSERT_EQ(result.status, 0) << file << "\n" << result.err;
    EXPECT_NEAR(summary("out").at("bodies").at("beam").at("volume").get<double>(), 0.04, 1e-9) << file;
    EXPECT_LT(summary("out").at("probes").at("tip").at("value").at(1).get<double>(), -0.01) << file;
  }
}

/// A cube as an OBJ file, whose vertices follow `before` others.
std::string obj_cube(double low, double high, int before) {
  std::string text;
  for (int k = 0; k < 8; ++k)
    text += "v " + std::to_string(k % 2 != 0 ? high : low) + " " + std::to_string(k / 2 % 2 != 0 ? high : low) + " " +
            std::to_string(k / 4 != 0 ? high : low) + "\n";
  for (const auto& quad :
       {std::array{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}}) {
    text += "f";
    for (const int node : quad) text += " " + std::to_string(node + before);
    text += "\n";
  }
  return text;
}

/// Parts of its surface lie inside of others, and face outward in the file: they bound cavities.
TEST_F(BadMesh, ARigidBodyIsHollowWhereItsSurfaceSaysSo) {
  write("hollow.obj", obj_cube(0, 4, 0) + obj_cube(1, 3, 8));
  write("hollow.toml",
        "[bodies.shell]\nmodel = \"rigid\"\ndomain = { file = \"hollow.obj\" }\ndensity = 10\n"
        "[solver]\nkind = \"implicit-euler\"\ntime_step = 1\nsteps = 1\n"
        "[probes.mass]\nquantity = \"mass\"\n[probes.volume]\nquantity = \"volume\"\n");
  const ProgramResult result = fascia({"run", "hollow.toml", "--output", "out"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("1 closed part lies inside another and bounds a cavity"), std::string::npos) << result.err;
  const auto value = [&](const char* probe) { return summary("out").at("probes").at(probe).at("value").get<double>(); };
  EXPECT_NEAR(value("mass"), 560, 1e-9);
  EXPECT_NEAR(value("volume"), 56, 1e-10);
}

/// Some callers ignore the signal of children that end, and what they start inherits it.
TEST_F(BadMesh, GoodOnesAreReadWhereEndsOfChildrenAreIgnored) {
  write("box.vtk", vtk_box());
  write_scene("box.vtk");
  ProgramOptions options;
  options.directory = folder_;
  options.environment = {"PROGRAM=" + program()};
  const ProgramResult result = run_program({"sh", "-c", "trap '' CHLD; exec \"$PROGRAM\" check scene.toml"}, options);
  EXPECT_EQ(result.status, 0) << result.err;
}

TEST_F(BadMesh, MeshThatIsInsideOutIsTurnedOverWithAMessage) {
  write("box.msh", gmsh_box(0));
  const ProgramResult result = run_with_domain("box.msh");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("turned over"), std::string::npos) << result.err;
}

TEST_F(BadMesh, AbsentFileIsAnErrorOfFiles) {
  const ProgramResult result = run_with_domain("absent.msh");
  EXPECT_EQ(result.status, 4);
  EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
  EXPECT_EQ(result.err.rfind("scene.toml:", 0), 0u) << "the scene's line: " << result.err;
  EXPECT_NE(result.err.find(": bodies.beam.domain.file: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("absent.msh: cannot be opened: it does not exist"), std::string::npos) << result.err;
}

TEST_F(BadMesh, MendedOnesRunWithAWarning) {
  const std::string copied = obj_box() + "f 3 2 1\n";
  const std::pair<std::string, std::string> cases[] = {
      {obj_box() + "\x1A", "left out 1 byte behind the last line"},
      {copied, "left out 1 triangle that has the nodes of another (triangle 13, which lies on triangle 1)"}};
  for (const auto& [text, says] : cases) {
    write("box.obj", text);
    const ProgramResult result = run_with_domain("box.obj");
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_NEAR(summary("out").at("bodies").at("beam").at("volume").get<double>(), 0.04, 1e-9);
  }
}

/// What is set already is no remedy.
TEST_F(BadMesh, PointsThatTheBoundaryCutsOffAreAdvisedOnce) {
  const std::string round = with(kCantilever, "{ box = { min = [0, 0, 0], max = [1, 0.2, 0.2] } }",
                                 "{ ellipsoid = { center = [0.5, 0.1, 0.1], radii = [0.5, 0.1, 0.1] } }");
  for (const std::string points : {"2, 2, 2", "3, 3, 3"}) {
    const std::string frames = "frames   = { grid = [9, 9, 9] }\npoints = { per_cell = [" + points + "] }\n";
    write("scene.toml", with(round, "frames   = { grid = [3, 2, 2] }\n", frames));
    const ProgramResult result = fascia({"check", "scene.toml"});
    const std::string said = result.out + result.err;
    EXPECT_NE(said.find("the domain hardly fills"), std::string::npos) << said;
    EXPECT_EQ(said.find("per_cell = [3, 3, 3]") == std::string::npos, points == "3, 3, 3") << said;
  }
}

TEST_F(BadMesh, InvertedCellAmongOthersIsNamedByItsNumber) { expect_refused("box.msh", gmsh_box(5), "6"); }

TEST_F(BadMesh, FlatCellIsNamedByItsNumber) {
  expect_refused("box.msh", with(gmsh_box(), "1 4 2 0 1 1 2 3 7\n", "1 4 2 0 1 1 2 3 4\n"), "1");
}

TEST_F(BadMesh, OpenSurfaceIsRefused) { expect_refused("box.obj", obj_box(2), "open"); }

TEST_F(BadMesh, NodeThatIsNotThereIsNamed) {
  expect_refused("box.msh", with(gmsh_box(), "1 4 2 0 1 1 2 3 7\n", "1 4 2 0 1 1 2 3 70\n"), "70");
}

TEST_F(BadMesh, CoordinateThatIsNoNumberIsRefused) {
  expect_refused("box.msh", with(gmsh_box(), "\n2 1.000000", "\n2 nan"), "box.msh:");
  expect_refused("box.obj", with(obj_box(), "v 1.000000 0.200000 0.200000", "v nan 0.2 0.2"), "");
}

TEST_F(BadMesh, TruncatedFilesAreRefused) {
  const std::string whole = gmsh_box();
  for (const std::size_t size : {whole.size() / 5, whole.size() / 2, whole.size() - 25}) {
    expect_refused("box.msh", whole.substr(0, size), "box.msh");
  }
}

TEST_F(BadMesh, FilesOfSomethingElseAreRefused) {
  std::string noise(4000, '\0');
  unsigned state = 12345;
  for (char& byte : noise) {
    state = state * 1664525u + 1013904223u;
    byte = static_cast<char>(state >> 24);
  }
  for (const char* ending : {"msh", "vtk", "vtu", "vtp", "stl", "obj", "ply"}) {
    expect_refused(std::string("noise.") + ending, noise, "");
    expect_refused(std::string("empty.") + ending, "", "");
  }
  expect_refused("box.xyz", gmsh_box(), "msh");
}

/// The reader would ask for as much memory as a header promises, or fill it for minutes.
TEST_F(BadMesh, HeadersThatPromiseMoreThanTheFileHolds) {
  const auto ply = [](const std::string& vertices, const std::string& faces) {
    return "ply\nformat ascii 1.0\nelement vertex " + vertices +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
           "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  };
  expect_refused("vertices.ply", ply("99999999999", "1"),
                 "vertices.ply:3: the number of vertices is 99999999999, but the file has only ");
  expect_refused("faces.ply", ply("3", "1000000"),
                 "faces.ply:7: the number of faces is 1000000, but the file has only ");
}

}  // namespace

}  // namespace fascia::bad_mesh_test
