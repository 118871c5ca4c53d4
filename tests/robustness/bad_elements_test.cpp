#include "tests/robustness/element_scenes.hpp"
#include "tests/unit/io/gmsh_samples.hpp"
#include "tests/unit/io/vtk_samples.hpp"

#include <cmath>
#include <string_view>

namespace fascia::bad_elements_test {

// Finite elements from wrong scenes and wrong mesh files: one line an error, status 2 (4: a file that cannot be read),
// nothing written, nothing computed.
namespace {

using namespace fascia::test;

class BadElements : public SceneRuns {
 protected:
  /// Runs the scene; the error is one line that names `place` and says `says`.
  void expect_refused(const std::string& scene, const std::string& place, const std::string& says,
                      int status = 2) const {
    write("scene.toml", scene);
    const auto before = snapshot();
    ProgramOptions options;
    options.timeout = std::chrono::seconds(20);
    const ProgramResult result = fascia({"run", "scene.toml"}, options);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
    EXPECT_NE(result.err.find(place), std::string::npos) << "should name '" << place << "': " << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << "should say '" << says << "': " << result.err;
    EXPECT_TRUE(snapshot() == before) << "files were written";
  }

  void expect_file_refused(const std::string& file, const std::string& content, const std::string& says,
                           const std::string& model = "tetrahedra") const {
    write(file, content);
    expect_refused(scene_of_file(file, model), file, says);
  }

  /// Runs the scene; the message is a warning that says `says`.
  void expect_warning(const std::string& scene, const std::string& says) const {
    write("scene.toml", scene);
    const ProgramResult result = fascia({"run", "scene.toml", "--output", "out"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.err.find("warning"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << "should say '" << says << "': " << result.err;
  }
};

struct WrongElements {
  const char* name;
  const char* from;  ///< text of the scene that is replaced
  const char* to;
  const char* key;   ///< path that the error names, or its beginning
  const char* says;  ///< a part of the message
};

void PrintTo(const WrongElements& wrong, std::ostream* out) { *out << wrong.name; }

constexpr const char* kCells = "cells = [5, 1, 1]";
constexpr const char* kUse = "material = \"soft\"";
constexpr const char* kStatic = "kind = \"static\"";
constexpr const char* kSolver = "[solver]\n";

const WrongElements kWrongScenes[] = {
    {"poisson_of_incompressible", "poisson = 0.3", "poisson = 0.5", "materials.soft.poisson", "below 0.5"},
    {"young_zero", "\"100 kPa\"", "0", "materials.soft.young", "above 0"},
    {"density_zero", "density  = 1000", "density = 0", "bodies.beam.density", "above 0"},
    {"density_nan", "density  = 1000", "density = nan", "bodies.beam.density", "nan"},
    {"order_three", kUse, "material = \"soft\"\norder = 3", "bodies.beam.order", "from 1 to 2"},
    {"cells_by_the_billion", kCells, "cells = [10000, 10000, 10000]", "bodies.beam.domain.box.cells", "at most"},
    {"cells_out_of_range", kCells, "cells = [1000000, 1, 1]", "bodies.beam.domain.box.cells[0]", "10000"},
    {"split_of_four", kCells, "cells = [5, 1, 1], split = 4", "bodies.beam.domain.box.split", "from 5 to 6"},
    {"penalty_negative", kUse, "material = \"soft\"\nincompressibility = -1", "bodies.beam.incompressibility",
     "at least 0"},
    {"locking_of_quadratic", kUse, "material = \"soft\"\norder = 2\nlocking = \"f-bar\"", "bodies.beam.locking",
     "order = 1"},
    {"law_of_small_strain", kUse,
     "material = { young = 1e5, poisson = 0.3, law = \"neo-hookean\" }\nformulation = \"corotational\"",
     "bodies.beam.material", "neo-hookean"},
    {"material_selects_nothing", kUse,
     "material = [{ where = { sphere = { center = [9, 9, 9], radius = 1 } }, use = \"soft\" }, { use = \"soft\" }]",
     "bodies.beam.material[0].where", "no element"},
    {"material_of_nodes", kUse, "material = [{ where = { ids = [0] }, use = \"soft\" }, { use = \"soft\" }]",
     "bodies.beam.material[0].where", "select nodes"},
    {"material_of_nodes_too", kUse, "material = [{ where = { any_of = [\"all\", { ids = [0] }] }, use = \"soft\" }]",
     "bodies.beam.material[0].where.any_of[1]", "select nodes"},
    {"rotations_of_vertices", kAllFixed, "fix = \"rotation\"", "constraints[0]", "rotations"},
    {"turn_of_vertices", kAllFixed, "move = { rotate = { axis = [1, 0, 0], angle = 1 }, axes = [\"rx\"] }",
     "constraints[0]", "rotations"},
    {"held_on_a_plane", kAllFixed, "fix = \"symmetry\"\nnormal = [1, 0, 0]", "bodies.beam", "translation along y"},
    {"held_at_an_edge", "max = [0.01, 1, 1]", "max = [0.01, 0.01, 1]", "bodies.beam", "rotation about z"},
    {"held_at_a_node", kClamp, "{ nearest = [0, 0, 0] }", "bodies.beam", "rotation about"},
    {"group_of_a_box", kClamp, "{ group = \"hilum\" }", "constraints[0].where", "no groups"},
    {"node_that_is_not_there", kClamp, "{ ids = [0, 24] }", "constraints[0].where", "0 to 23"},
    {"interior_of_a_slender_beam", kClamp, "{ not = { boundary = true } }", "constraints[0].where", "selects no node"},
    {"motions_that_contradict", kSolver,
     "[[constraints]]\nbody = \"beam\"\nwhere = { ids = [0] }\nmove = { translate = [0, 0.1, 0] }\n[solver]\n",
     "constraints[1]", "another value"},
    {"axes_that_are_oblique", kAllFixed, "fix = [\"x\"]\naxes = [[1, 0, 0], [1, 1, 0], [0, 0, 1]]",
     "constraints[0].axes", "perpendicular"},
    {"traction_on_a_node", kSolver,
     "[[loads]]\nbody = \"beam\"\nwhere = { nearest = [1, 0, 0] }\ntraction = [1, 0, 0]\n[solver]\n", "loads[0].where",
     "no face"},
    {"force_outside", kSolver, "[[loads]]\nbody = \"beam\"\nat = [1.5, 0.1, 0.1]\nforce = [1, 0, 0]\n[solver]\n",
     "loads[0].at", "0.5 m outside"},
    {"load_nan", kSolver, "[[loads]]\nbody = \"beam\"\nat = [1, 0.1, 0.1]\nforce = [0, nan, 0]\n[solver]\n",
     "loads[0].force[1]", "finite"},
    {"probe_outside", "at = [1, 0.1, 0.1]", "at = [1.5, 0.1, 0.1]", "probes.tip.at", "0.5 m outside"},
    {"explicit_step_too_large", kStatic, "kind = \"explicit\"\ntime_step = 1\nsteps = 3", "solver.time_step", "stable"},
    {"explicit_auto_without_end", kStatic, "kind = \"explicit\"\ntime_step = \"auto\"", "solver.duration", "missing"},
    {"explicit_for_ever", kStatic, "kind = \"explicit\"\ntime_step = \"auto\"\nduration = 1e12", "solver.time_step",
     "steps"},
    {"scale_zero", kUse, "material = \"soft\"\ntransform = { scale = 0 }", "bodies.beam.transform.scale", "above 0"},
    {"rotation_about_nothing", kUse, "material = \"soft\"\ntransform = { rotate = { axis = [0, 0, 0], angle = 1 } }",
     "bodies.beam.transform.rotate.axis", "no direction"},
    {"moved_beyond_rounding", kUse, "material = \"soft\"\ntransform = { translate = [0, 1e15, 0] }", "bodies.beam",
     "translate"},
    {"moved_beyond_all_digits", kUse, "material = \"soft\"\ntransform = { translate = [0, 1e17, 0] }", "bodies.beam",
     "translate"}};

class BadElementScene : public BadElements, public ::testing::WithParamInterface<WrongElements> {};

TEST_P(BadElementScene, IsRefusedWithItsPlace) {
  const WrongElements& wrong = GetParam();
  expect_refused(with(kElements, wrong.from, wrong.to), std::string(": ") + wrong.key, wrong.says);
}

INSTANTIATE_TEST_SUITE_P(Scenes, BadElementScene, ::testing::ValuesIn(kWrongScenes),
                         [](const auto& instance) { return instance.param.name; });

struct SpoiledMesh {
  const char* name;
  std::string_view model;
  FileMesh (*spoil)();
  const char* says;
};

void PrintTo(const SpoiledMesh& spoiled, std::ostream* out) { *out << spoiled.name; }

template <class Edit>
FileMesh edited(FileMesh mesh, const Edit& edit) {
  edit(mesh);
  return mesh;
}

FileMesh with_cell(FileMesh mesh, int type, std::vector<int> nodes) {
  mesh.cells.push_back({type, 1, std::move(nodes)});
  return mesh;
}

/// Two beams, the second apart from the first.
FileMesh two_beams() {
  FileMesh mesh = tetrahedra_beam();
  const std::size_t cells = mesh.cells.size();
  const int nodes = static_cast<int>(mesh.nodes.size());
  for (int i = 0; i < nodes; ++i) {
    auto X = mesh.nodes[static_cast<std::size_t>(i)];
    X[0] += 1.5;
    mesh.nodes.push_back(X);
  }
  for (std::size_t c = 0; c < cells; ++c) {
    FileCell cell = mesh.cells[c];
    if (cell.type != FileMesh::tetrahedron) continue;
    for (int& node : cell.nodes) node += nodes;
    mesh.cells.push_back(cell);
  }
  return mesh;
}

FileMesh only(FileMesh mesh, int type) {
  std::erase_if(mesh.cells, [&](const FileCell& cell) { return cell.type != type; });
  return mesh;
}

/// The quadratic beam with a middle node of its first element on the way to the other end of its edge.
FileMesh shifted_middle(double part) {
  FileMesh mesh = quadratic_beam();
  const std::vector<int>& nodes = mesh.cells[0].nodes;
  const auto X = [&](std::size_t k) -> auto& { return mesh.nodes[static_cast<std::size_t>(nodes[k])]; };
  for (std::size_t c = 0; c < 3; ++c) X(4)[c] = X(0)[c] + part * (X(1)[c] - X(0)[c]);
  return mesh;
}

constexpr std::string_view kTetrahedra = "tetrahedra", kHexahedra = "hexahedra", kQuadratic = "tetrahedra of order 2";

const SpoiledMesh kSpoiledMeshes[] = {
    {"one_inverted", kTetrahedra, [] { return edited(tetrahedra_beam(), [](auto& m) { m.swap_nodes(4, 0, 1); }); },
     "element 5 is turned the wrong way round (1 of 12 elements)"},
    {"all_but_one_inverted", kTetrahedra,
     [] {
       return edited(tetrahedra_beam(), [](auto& m) {
         for (std::size_t c = 1; c < 12; ++c) m.swap_nodes(c, 0, 1);
       });
     },
     "element 1 is turned against the others (1 of 12 elements)"},
    {"hexahedron_twisted", kHexahedra, [] { return edited(hexahedra_beam(), [](auto& m) { m.swap_nodes(1, 2, 3); }); },
     "element 2 is folded"},
    {"flat", kTetrahedra,
     [] {
       return with_cell(tetrahedra_beam(), FileMesh::tetrahedron, {0, 1, 4, 3});
     },
     "element 15 is flat"},
    {"all_flat", kHexahedra,
     [] {
       return edited(hexahedra_beam(), [](auto& m) {
         for (auto& X : m.nodes) X[2] = 0;
       });
     },
     "element 1 is flat"},
    {"node_twice", kTetrahedra, [] { return edited(tetrahedra_beam(), [](auto& m) { m.cells[2].nodes[1] = 0; }); },
     "element 3 uses node 1 twice"},
    {"repeated_in_another_order", kHexahedra,
     [] {
       return edited(hexahedra_beam(), [](auto& m) {
         m.cells.push_back(m.cells[0]);
         std::swap(m.cells.back().nodes[0], m.cells.back().nodes[1]);
       });
     },
     "elements 1 and 3 have the same nodes"},
    {"node_too_high", kTetrahedra, [] { return edited(tetrahedra_beam(), [](auto& m) { m.cells[2].nodes[1] = 98; }); },
     "element 3 uses node 99"},
    {"node_negative", kTetrahedra, [] { return edited(tetrahedra_beam(), [](auto& m) { m.cells[2].nodes[1] = -7; }); },
     "element 3 uses node -6"},
    {"coordinate_nan", kTetrahedra, [] { return edited(tetrahedra_beam(), [](auto& m) { m.nodes[4][0] = NAN; }); },
     ":16: "},
    {"coordinate_infinite", kTetrahedra,
     [] { return edited(tetrahedra_beam(), [](auto& m) { m.nodes[4][0] = -INFINITY; }); }, ":16: "},
    {"coordinate_huge", kTetrahedra, [] { return edited(tetrahedra_beam(), [](auto& m) { m.nodes[4][0] = 1e70; }); },
     "node 5 has a coordinate"},
    {"mixed_types", kTetrahedra,
     [] {
       return with_cell(tetrahedra_beam(), FileMesh::hexahedron, {1, 2, 5, 4, 7, 8, 11, 10});
     },
     "mixes 12 tetrahedra"},
    {"triangles_only", kTetrahedra, [] { return only(tetrahedra_beam(), FileMesh::triangle); }, "triangles only"},
    {"wedges", kTetrahedra,
     [] {
       return with_cell(only(hexahedra_beam(), 0), FileMesh::wedge, {0, 1, 3, 6, 7, 9});
     },
     "wedges"},
    {"no_cells", kTetrahedra, [] { return only(hexahedra_beam(), 0); }, "no cells"},
    {"tetrahedra_for_hexahedra", kHexahedra, tetrahedra_beam, "use model = \"tetrahedra\""},
    {"hexahedra_for_tetrahedra", kTetrahedra, [] { return hexahedra_beam(); }, "use model = \"hexahedra\""},
    {"two_parts_one_held", kTetrahedra, two_beams, "12 nodes around (2, 0.1, 0.1)"},
    {"middle_node_far_outside", kQuadratic, [] { return shifted_middle(3); }, "elements 1, 6 are folded"},
    {"middle_node_folds_a_corner", kQuadratic, [] { return shifted_middle(0.9); }, "folded"},
    {"middle_node_on_a_corner", kQuadratic, [] { return shifted_middle(0); }, "folded"},
    {"linear_and_quadratic", kQuadratic,
     [] { return edited(quadratic_beam(), [](auto& m) { m.cells[0] = tetrahedra_beam().cells[0]; }); },
     "mixes linear and quadratic"}};

class BadElementMesh : public BadElements, public ::testing::WithParamInterface<SpoiledMesh> {};

TEST_P(BadElementMesh, IsRefusedByItsOwnNumbers) {
  const SpoiledMesh& spoiled = GetParam();
  write("beam.msh", spoiled.spoil().text());
  const bool quadratic = spoiled.model == kQuadratic;
  std::string scene = scene_of_file("beam.msh", std::string(quadratic ? kTetrahedra : spoiled.model));
  if (quadratic) scene = with(scene, kUse, "material = \"soft\"\norder = 2");
  const bool of_file = std::string(spoiled.says).find("around") == std::string::npos;
  expect_refused(scene, of_file ? "bodies.beam.domain: beam.msh:" : "bodies.beam", spoiled.says);
}

INSTANTIATE_TEST_SUITE_P(Meshes, BadElementMesh, ::testing::ValuesIn(kSpoiledMeshes),
                         [](const auto& instance) { return instance.param.name; });

/// A unit tetrahedron in big-endian binary, as VTK's legacy format wants it.
std::string binary_vtk() {
  std::string text = "# vtk DataFile Version 3.0\nsample\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n";
  const auto number = [&](double value) {
    std::array<char, 8> bytes{};
    std::memcpy(bytes.data(), &value, bytes.size());
    text.append(bytes.rbegin(), bytes.rend());
  };
  const auto integer = [&](int value) { text += std::string(3, '\0') + static_cast<char>(value); };
  for (const double x : {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}) number(x);
  text += "\nCELLS 1 5\n";
  for (const int n : {4, 0, 1, 2, 3}) integer(n);
  text += "\nCELL_TYPES 1\n";
  integer(10);
  return text + "\n";
}

TEST_F(BadElements, FilesCutOffAnywhereAreRefused) {
  using namespace fascia::samples;
  const std::pair<const char*, std::string> files[] = {
      {"text_22.msh", gmsh_22()},          {"binary_22.msh", gmsh_22_binary()}, {"text_41.msh", gmsh_41()},
      {"binary_41.msh", gmsh_41_binary()}, {"text.vtk", vtk_samples[1].text},   {"binary.vtk", binary_vtk()},
      {"text.vtu", vtk_samples[2].text}};
  for (const auto& [file, whole] : files) {
    std::string scene = scene_of_file(file);
    scene = with(with(scene, "min = [-0.01, -1, -1]", "min = [-1, -1, -1]"), "[1, 0.1, 0.1]", "[0.3, 0.3, 0.3]");
    write("scene.toml", scene);
    write(file, whole);
    EXPECT_EQ(fascia({"check", "scene.toml"}).status, 0) << file;
    constexpr std::size_t cuts = 10;
    for (std::size_t k = 0; k < cuts; ++k) {  // the last byte or two may be a line's end
      write(file, whole.substr(0, (whole.size() - 3) * k / (cuts - 1)));
      const ProgramResult result = fascia({"check", "scene.toml"});
      EXPECT_EQ(result.status, 2) << file << " at cut " << k << ": " << result.err;
      EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
      EXPECT_NE(result.err.find(file), std::string::npos) << result.err;
      EXPECT_EQ(result.err.find("(0x"), std::string::npos) << "no addresses of memory: " << result.err;
    }
  }
}

TEST_F(BadElements, FilesThatCannotBeReadAreErrorsOfFiles) {
  std::filesystem::create_directory(folder_ / "folder.msh");
  for (const char* file : {"absent.msh", "absent.vtk", "folder.msh"}) expect_refused(scene_of_file(file), file, ";", 4);
}

TEST_F(BadElements, FilesOfSomethingElseAreRefused) {
  std::string noise(4000, '\0');
  unsigned state = 12345;
  for (char& byte : noise) {
    state = state * 1664525u + 1013904223u;
    byte = static_cast<char>(state >> 24);
  }
  for (const char* ending : {"msh", "vtk", "vtu", "obj"}) {
    expect_file_refused(std::string("noise.") + ending, noise, ";");
    expect_file_refused(std::string("empty.") + ending, "", "empty");
  }
}

TEST_F(BadElements, VtkNodesOutOfRangeAreNamed) {
  using fascia::samples::vtk_samples;
  expect_file_refused("mesh.vtk", with(vtk_samples[1].text, "4 0 1 2 3", "4 0 1 2 30"), "cell 0 uses node 30");
  expect_file_refused("mesh.vtu", with(vtk_samples[2].text, ">0 1 2 3<", ">0 1 -2 3<"), "cell 0 uses node -2");
  expect_file_refused("mesh.vtu", with(vtk_samples[2].text, ">0 0 0 1", ">0 0 nan 1"), "node 0");
}

TEST_F(BadElements, MeshFileInsideOutIsTurnedOverWithAMessage) {
  FileMesh mesh = tetrahedra_beam();
  for (std::size_t c = 0; c < 12; ++c) mesh.swap_nodes(c, 0, 1);
  write("beam.msh", mesh.text());
  expect_warning(scene_of_file("beam.msh"), "all 12 elements are turned the wrong way round; turned over");
}

TEST_F(BadElements, WhatIsLeftUnusedIsSaid) {
  write("node.msh", edited(tetrahedra_beam(), [](auto& m) { m.nodes.push_back({5, 5, 5}); }).text());
  expect_warning(scene_of_file("node.msh"), "no element uses (the first: node 13)");
  write("quadratic.msh", quadratic_beam().text());
  expect_warning(scene_of_file("quadratic.msh"), "only their corners are used");
  write("group.msh", edited(tetrahedra_beam(), [](auto& m) { m.names += "2 9 \"nowhere\"\n"; }).text());
  expect_warning(scene_of_file("group.msh"), "\"nowhere\"");
}

TEST_F(BadElements, GroupsAreNamed) {
  write("beam.msh", tetrahedra_beam().text());
  const std::string scene = scene_of_file("beam.msh");
  for (const char* group : {"\"hylum\"", "77"}) {
    const std::string where = with(scene, kClamp, std::string("{ group = ") + group + " }");
    expect_refused(where, "constraints[0].where", "\"organ\", \"stiff\", \"hilum\"");
  }
  const std::string inner = with(scene, kClamp, "{ not = { group = \"nope\" } }");
  expect_refused(inner, "constraints[0].where.not", "nope");
  const std::string surface =
      with(scene, kUse, "material = [{ where = { group = \"hilum\" }, use = \"soft\" }, { use = \"soft\" }]");
  expect_refused(surface, "bodies.beam.material[0].where", "no element");
  const std::string part = with(scene, kUse, "material = [{ where = { group = \"stiff\" }, use = \"soft\" }]");
  expect_refused(part, "bodies.beam", "no material at");
}

TEST_F(BadElements, GroupsThatANumberOrNameDoesNotTellApartAreRefused) {
  FileMesh mesh = tetrahedra_beam();
  mesh.names += "3 5 \"other\"\n3 6 \"hilum\"\n";
  mesh.cells[10].group = 5;
  mesh.cells[11].group = 6;
  write("beam.msh", mesh.text());
  for (const char* group : {"5", "\"hilum\""})  // of triangles and of tetrahedra alike
    expect_refused(with(scene_of_file("beam.msh"), kClamp, std::string("{ group = ") + group + " }"),
                   "constraints[0].where", "hilum");
}

}  // namespace

}  // namespace fascia::bad_elements_test
