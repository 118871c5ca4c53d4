// Finite elements: other programs' results on the same meshes, the soft cantilever, closed forms, frequencies.
#include "tests/support/paths.hpp"
#include "tests/support/solved_scene.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <utility>

namespace fascia::test::elements_test {
namespace {

using Vector = std::array<double, 3>;
using Cells = std::array<int, 3>;

std::string text(const Cells& c) {
  return "[" + std::to_string(c[0]) + "," + std::to_string(c[1]) + "," + std::to_string(c[2]) + "]";
}

std::string number(double v) {
  char line[40];
  std::snprintf(line, sizeof line, "%.17g", v);
  return line;
}

SolvedScene run(const std::string& scene, const Settings& settings) { return SolvedScene(scene, settings, 1); }

/// A scene that is written here.
SolvedScene run_text(const std::string& scene, const Settings& settings = {}) {
  const TemporaryFolder folder;
  const std::string file = (folder.path / "case").string();
  std::ofstream(file + ".toml") << scene;
  return run(file, settings);
}

double percent(double value, double reference) { return 100 * (value / reference - 1); }

// Targets: references.csv 12. Two programs give the coarse one to all of its digits.
TEST(LiverTetrahedra, SameMeshAsOtherPrograms) {
  struct Mesh {
    const char* name;
    double largest;
    Vector place, u;
    int nodes, cells;
  };
  const Mesh meshes[] = {
      {"liver_c", 0.0069270122, {0.0930518, 0.0176156, -0.00941071}, {-0.00359221, -0.000445682, -0.005906}, 499, 1904},
      {"liver_m",
       0.0076654729,
       {0.0957974, 0.0232152, -0.00194558},
       {-0.00379975, -0.000631516, -0.00662741},
       1279,
       5655}};
  std::printf("mesh            max |u| [m]     reference       u of that node [m]\n");
  for (const Mesh& m : meshes)
    for (const char* version : {"_v22", "_v41"}) {
      const std::filesystem::path file =
          fascia::test::shared_dir() / "meshes" / (m.name + std::string(version) + ".msh");
      if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
      const SolvedScene liver = run("liver_tetrahedra", {"bodies.liver.domain.file='" + file.string() + "'",
                                                         "probes.farthest.at=[" + number(m.place[0]) + "," +
                                                             number(m.place[1]) + "," + number(m.place[2]) + "]"});
      const Vector u = liver.vector("farthest");
      std::printf("%s%s   %.11f  %.10f   %.9f %.10f %.9f\n", m.name, version, liver.number("sag"), m.largest, u[0],
                  u[1], u[2]);
      EXPECT_NEAR(liver.number("sag"), m.largest, 1e-9);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(u[k], m.u[k], 1e-8) << "its six digits; so has its place";
      EXPECT_EQ(liver.summary()["bodies"]["liver"]["nodes"], m.nodes);
      EXPECT_EQ(liver.summary()["bodies"]["liver"]["cells"], m.cells);
    }
}

TEST(SoftCantileverElements, QuadraticHexahedraOnTheSameMesh) {
  struct Case {
    Cells cells;
    Vector reference;  // tip u_x, u_y, max |u|
  };
  const Case cases[] = {{{16, 2, 2}, {-1.582189, -6.471733, 6.678654}}, {{32, 4, 4}, {-1.593629, -6.497999, 6.706954}}};
  std::printf("cells       u_x, u_y, max |u| [m]            reference\n");
  for (const Case& c : cases) {
    const SolvedScene beam = run("soft_cantilever_hexahedra", {"bodies.beam.domain.box.cells=" + text(c.cells)});
    const Vector tip = beam.vector("tip");
    const double largest = beam.number("largest");
    std::printf("%2d x %d x %d   %.7f %.7f %.7f   %.6f %.6f %.6f\n", c.cells[0], c.cells[1], c.cells[2], tip[0], tip[1],
                largest, c.reference[0], c.reference[1], c.reference[2]);
    EXPECT_NEAR(tip[0], c.reference[0], 1.5e-6) << "the last of its printed digits";
    EXPECT_NEAR(tip[1], c.reference[1], 1.5e-6);
    EXPECT_NEAR(largest, c.reference[2], 1.5e-6);
    EXPECT_NEAR(beam.vector("support_force")[1], 5 * 9.81, 1e-6);
  }
}

// SOFA's drops of the end face's centre; physics.md 2.4 has those of its upper corner against 6.575 m.
TEST(SoftCantileverElements, Hexahedra) {
  struct Case {
    Cells cells;
    double sofa, corner;  // drop [m], error [%]; 0: none
  };
  const Case cases[] = {{{8, 2, 2}, 0, -56.7},  {{20, 2, 2}, 5.294, -18.7}, {{32, 3, 3}, 0, -8.4},
                        {{32, 4, 4}, 5.992, 0}, {{64, 4, 4}, 6.330, -2.59}, {{16, 1, 1}, 0, -30},
                        {{32, 1, 1}, 0, -16},   {{64, 1, 1}, 0, -12}};
  std::printf("cells       co-rotational   SOFA [m]      St V.-K.   corner [%%]  reference [%%]\n");
  for (const Case& c : cases) {
    const Settings mesh{"bodies.beam.domain.box.cells=" + text(c.cells), "bodies.beam.order=1",
                        "probes.tip.at=[[16,0,0],[16,0.5,0.5]]"};
    Settings turning = mesh;
    turning.push_back("bodies.beam.formulation='corotational'");
    const SolvedScene svk = run("soft_cantilever_hexahedra", mesh),
                      corotational = run("soft_cantilever_hexahedra", turning);
    const std::vector<Vector> u = svk.vectors("tip"), w = corotational.vectors("tip");
    ASSERT_TRUE(u.size() == 2 && w.size() == 2);
    const double corner = percent(-u[1][1], 6.575);
    std::printf("%2d x %d x %d   %12.4f %10.3f %13.4f %11.2f %11.2f\n", c.cells[0], c.cells[1], c.cells[2], -w[0][1],
                c.sofa, -u[0][1], corner, c.corner);
    if (c.sofa > 0) {
      EXPECT_NEAR(-w[0][1] / c.sofa, 1, 3e-4) << "four printed digits";
    }
    if (c.corner < 0) {
      EXPECT_NEAR(corner, c.corner, c.corner > -5 ? 0.01 : c.cells[1] == 1 ? 0.5 : 0.1) << "its printed digits";
    }
    EXPECT_NEAR(-w[0][1] / -u[0][1], 1, 1e-3) << "strains are small";
  }
}

// physics.md 2.4 has 27-node hexahedra, 17 x 3 x 3, 33 x 3 x 3 and 65 x 3 x 3 nodes: -1.28, -0.35, -0.08 %. The 20-node
// ones lack the functions of faces and middle, and are stiffer on a section of one element.
TEST(SoftCantileverElements, SerendipityBesideTriquadratic) {
  const std::pair<Cells, double> cases[] = {{{8, 1, 1}, -1.28}, {{16, 1, 1}, -0.35}, {{32, 1, 1}, -0.08}};
  std::printf("cells       20 nodes [%%]   27 nodes [%%]\n");
  double previous = -100;
  for (const auto& [cells, other] : cases) {
    const SolvedScene beam =
        run("soft_cantilever_hexahedra", {"bodies.beam.domain.box.cells=" + text(cells), "probes.tip.at=[16,0.5,0.5]"});
    const double error = percent(-beam.vector("tip")[1], 6.575);
    std::printf("%2d x %d x %d   %10.2f %14.2f\n", cells[0], cells[1], cells[2], error, other);
    EXPECT_LT(error, other);
    EXPECT_GT(error, 2.5 * other - 0.1);
    EXPECT_GT(error, previous);
    previous = error;
  }
}

/// Six tetrahedra of a cell in the numbers of a hexahedron.
using Split = std::array<std::array<int, 4>, 6>;
/// SOFA, Hexa2TetraTopologicalMapping.
constexpr Split kSofaSplit{{{0, 5, 1, 6}, {0, 1, 3, 6}, {1, 3, 6, 2}, {6, 3, 0, 7}, {6, 7, 0, 5}, {7, 5, 4, 0}}};
/// Around the diagonal, with all faces' diagonals from the same corner.
constexpr Split kDiagonalSplit{{{0, 1, 2, 6}, {0, 5, 1, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 4, 5, 6}, {0, 7, 4, 6}}};

/// The beam as a Gmsh file; mirrored: every second cell along each axis is the mirror image of its neighbours.
void write_beam(const std::filesystem::path& path, const Cells& cells, const Split& split, bool mirrored) {
  std::ofstream file(path);
  file.precision(17);
  const int n[3] = {cells[0] + 1, cells[1] + 1, cells[2] + 1};
  file << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << n[0] * n[1] * n[2] << '\n';
  int id = 0;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        file << ++id << ' ' << 16.0 * i / cells[0] << ' ' << -0.5 + 1.0 * j / cells[1] << ' '
             << -0.5 + 1.0 * k / cells[2] << '\n';
  file << "$EndNodes\n$Elements\n" << 6 * cells[0] * cells[1] * cells[2] << '\n';
  constexpr unsigned kCorner[8] = {0, 1, 3, 2, 4, 5, 7, 6};  // bits: on the far side along x, y, z
  id = 0;
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i) {
        const unsigned flip = mirrored ? static_cast<unsigned>(i % 2) | static_cast<unsigned>(j % 2) << 1 |
                                             static_cast<unsigned>(k % 2) << 2
                                       : 0u;
        for (std::array<int, 4> tetrahedron : split) {
          if (std::popcount(flip) % 2 == 1) std::swap(tetrahedron[2], tetrahedron[3]);
          file << ++id << " 4 2 1 1";
          for (const int corner : tetrahedron) {
            const int c = static_cast<int>(kCorner[corner] ^ flip);
            file << ' ' << 1 + (i + (c & 1)) + n[0] * ((j + (c >> 1 & 1)) + n[1] * (k + (c >> 2)));
          }
          file << '\n';
        }
      }
  file << "$EndElements\n";
}

SolvedScene beam_of_mesh(const std::filesystem::path& mesh, const std::string& formulation) {
  return run_text("[world]\ngravity = [0, -9.81, 0]\n[bodies.beam]\nmodel = \"tetrahedra\"\ndomain = { file = \"" +
                  mesh.string() + "\" }\nmass = 5\nmaterial = { young = 40e3, poisson = 0.3 }\nformulation = \"" +
                  formulation + R"("
[[constraints]]
body = "beam"
where = { box = { min = [-0.01, -1, -1], max = [0.01, 1, 1] } }
fix = "all"
[solver]
kind = "static"
[probes.tip]
body = "beam"
at = [[16, 0, 0], [16, 0.5, 0.5]]
quantity = "displacement"
)");
}

// SOFA's way of splitting the cells accounts for its St Venant-Kirchhoff drops to all their digits. Its co-rotational
// ones differ by the rotation too: its "large" method takes it from three of a tetrahedron's nodes, not from the polar
// decomposition. The column "edges" is an independent solution with that rotation.
TEST(SoftCantileverElements, TetrahedraSplitAsInSofa) {
  struct Case {
    Cells cells;
    double svk, corotational, edges;
  };
  const Case cases[] = {
      {{20, 2, 2}, 2.529, 2.591, 2.5914}, {{32, 4, 4}, 4.067, 4.170, 4.1696}, {{64, 4, 4}, 5.215, 5.405, 5.4051}};
  const TemporaryFolder folder;
  std::printf("cells        St V.-K.    SOFA     co-rotational    SOFA    edges   difference\n");
  for (const Case& c : cases) {
    const std::filesystem::path mesh = folder.path / "beam.msh";
    write_beam(mesh, c.cells, kSofaSplit, false);
    const std::vector<Vector> u = beam_of_mesh(mesh, "st-venant-kirchhoff").vectors("tip");
    const std::vector<Vector> w = beam_of_mesh(mesh, "corotational").vectors("tip");
    ASSERT_TRUE(u.size() == 2 && w.size() == 2);
    const double difference = percent(-w[0][1], c.corotational);
    std::printf("%2d x %d x %d   %9.4f %8.3f %14.4f %9.3f %9.4f %+8.1f %%\n", c.cells[0], c.cells[1], c.cells[2],
                -u[0][1], c.svk, -w[0][1], c.corotational, c.edges, difference);
    EXPECT_NEAR(-u[0][1], c.svk, 6e-4) << "four printed digits";
    EXPECT_NEAR(w[0][1] / u[0][1], 1, 2e-3) << "strains are small";
    EXPECT_LT(difference, -2);
    EXPECT_GT(difference, -4);
  }
}

// physics.md 2.4, column tet4: cells split in 6, mirrored from cell to cell. With all diagonals one way the same number
// of tetrahedra is stiffer and moves sideways.
TEST(SoftCantileverElements, TetrahedraOfMirroredCells) {
  const std::pair<Cells, double> cases[] = {{{8, 2, 2}, -80},  {{20, 2, 2}, -45}, {{32, 3, 3}, -26},
                                            {{64, 4, 4}, -11}, {{16, 1, 1}, -67}, {{32, 1, 1}, -62}};
  const TemporaryFolder folder;
  std::printf("cells         split = 6   reference   split = 5   one way [%%]\n");
  for (const auto& [cells, reference] : cases) {
    const std::filesystem::path mesh = folder.path / "beam.msh";
    write_beam(mesh, cells, kDiagonalSplit, false);
    const std::vector<Vector> one_way = beam_of_mesh(mesh, "st-venant-kirchhoff").vectors("tip");
    ASSERT_EQ(one_way.size(), 2u);
    double own[2];
    for (const int split : {6, 5})
      own[6 - split] =
          percent(-run("soft_cantilever_tetrahedra",
                       {"bodies.beam.order=1", "bodies.beam.domain.box.cells=" + text(cells),
                        "bodies.beam.domain.box.split=" + std::to_string(split), "probes.tip.at=[16,0.5,0.5]"})
                       .vector("tip")[1],
                  6.575);
    std::printf("%2d x %d x %d   %9.1f %10.0f %11.1f %11.1f\n", cells[0], cells[1], cells[2], own[0], reference, own[1],
                percent(-one_way[1][1], 6.575));
    EXPECT_NEAR(own[0], reference, 0.5) << "its printed digits";
    EXPECT_LT(own[1], 0);
  }
}

// Tractions are integrated over the curved faces of quadratic elements, not over flat facets between their nodes.
TEST(ElementLoads, TractionOnARoundFace) {
  for (const char* model : {"tetrahedra", "hexahedra"}) {
    const SolvedScene rod = run_text(std::string("[bodies.rod]\nmodel = \"") + model + R"("
domain = { cylinder = { from = [0, 0, 0], to = [0.1, 0, 0], radius = 0.01, cells = [4, 8] } }
order = 2
density = 1000
material = { young = 1e4, poisson = 0.3 }
[[constraints]]
body = "rod"
where = { box = { min = [-0.001, -1, -1], max = [0.001, 1, 1] } }
fix = "all"
[[loads]]
body = "rod"
where = { box = { min = [0.0999, -1, -1], max = [0.1001, 1, 1] } }
traction = [1, 0, 0]
[solver]
kind = "static"
[probes.support]
body = "rod"
quantity = "force"
where = { box = { min = [-0.001, -1, -1], max = [0.001, 1, 1] } }
)");
    const double area = static_cast<double>(rod.summary()["bodies"]["rod"]["volume"]) / 0.1;
    EXPECT_NEAR(-rod.vector("support")[0], area, 1e-9 * area) << model;
    EXPECT_NEAR(area, 3.14159265e-4, 2e-3 * 3.14e-4) << model;
  }
}

// A Poisson ratio of 0.45 is not above 0.45, whatever rounding makes of lambda and mu.
TEST(ElementLoads, StiffnessDoesNotChooseTheElements) {
  for (const char* young : {"5e6", "5e3", "8e7", "2e8"}) {
    const SolvedScene block = run_text(std::string(R"(silence = ["held"]
[bodies.block]
model = "tetrahedra"
domain = { box = { min = [0, 0, 0], max = [1, 1, 1], cells = [1, 1, 1] } }
density = 1000
material = { poisson = 0.45, young = )") +
                                       young + R"( }
[[constraints]]
body = "block"
where = "all"
fix = "all"
[solver]
kind = "static"
)");
    EXPECT_TRUE(block.summary()["warnings"].empty()) << young << block.summary()["warnings"].dump();
  }
}

// references.md 9. The lumped mass of 20-node hexahedra lies far out on the section: its polar inertia about the beam's
// axis is 1 + 1.226 / n^2 times the true one with n elements across, which lowers the frequency of torsion.
TEST(ElementModes, SteelCantilever) {
  const std::string scene = R"([bodies.beam]
model = "hexahedra"
domain = { box = { min = [0, -0.25, -0.25], max = [16, 0.25, 0.25], cells = [32, 2, 2] } }
order = 2
mass = 31200
material = { young = 200e9, poisson = 0.3 }
[[constraints]]
body = "beam"
where = { box = { min = [-0.01, -1, -1], max = [0.01, 1, 1] } }
fix = "all"
[solver]
kind = "modes"
count = 12
[probes.frequency]
quantity = "frequency"
)";
  struct Mode {
    const char* name;
    double solid;
    int copies;
  };
  const Mode modes[] = {{"bending 1", 1.5988, 2}, {"bending 2", 9.974, 2}, {"bending 3", 27.73, 2},
                        {"torsion 1", 45.08, 1},  {"bending 4", 53.77, 2}, {"axial 1", 79.19, 1},
                        {"bending 5", 87.7, 2}};
  for (const int across : {2, 3}) {
    const SolvedScene beam =
        run_text(scene, {"bodies.beam.domain.box.cells=" + text({across == 2 ? 32 : 16, across, across})});
    const nlohmann::json f = beam.probe("frequency");
    ASSERT_EQ(f.size(), 12u);
    std::size_t i = 0;
    std::printf("%d across     f [Hz]     solid [Hz]   error\n", across);
    for (const Mode& m : modes)
      for (int copy = 0; copy < m.copies; ++copy, ++i) {
        const bool torsion = m.solid == 45.08;
        const double value = f[i].get<double>(), lumped = torsion ? 1 / std::sqrt(1 + 1.226 / (across * across)) : 1.0;
        std::printf("%-10s %9.4f %12.4f %+7.2f %%\n", m.name, value, m.solid, percent(value, m.solid));
        EXPECT_NEAR(value / (m.solid * lumped), 1.0, torsion ? 0.01 : 0.004) << m.name;
      }
  }
}

}  // namespace
}  // namespace fascia::test::elements_test
