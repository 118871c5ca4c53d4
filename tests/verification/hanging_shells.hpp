#pragma once

#include "tests/support/solved_scene.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <vector>

/// scenes/hanging_shells.toml as one solid mesh: a quarter of it, with symmetry.
namespace fascia::test {

/// Cells along half the tied square, along the overhang, over the tissue's height; they are finer towards the tissue's
/// edges. A wall has one layer.
struct SolidMesh {
  bool tetrahedra = false;
  int tied = 3, overhang = 5, height = 3;
};

/// Sag of the lower wall [m]: of its centre, and the mean over the tied square.
struct Sag {
  double centre = 0, mean = 0;
};

constexpr int kSamples = 10;  // intervals of half the tied square

/// The tied square, or a quarter of it, as a list of points for a probe. @param from  −1: the whole square; 0
inline std::string points_of_square(int from, double z) {
  std::string list;
  for (int i = from * kSamples; i <= kSamples; ++i)
    for (int j = from * kSamples; j <= kSamples; ++j)
      list += fmt::format("{}[{},{},{}]", list.empty() ? "" : ",", 0.2 * i / kSamples, 0.2 * j / kSamples, z);
  return "[" + list + "]";
}

/// By the trapezoidal rule over points_of_square().
inline double mean_sag(const std::vector<std::array<double, 3>>& u) {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(u.size()))));
  double sum = 0, weights = 0;
  for (std::size_t k = 0; k < u.size(); ++k) {
    const bool i_end = k / n == 0 || k / n == n - 1, j_end = k % n == 0 || k % n == n - 1;
    const double weight = (i_end ? 0.5 : 1) * (j_end ? 0.5 : 1);
    sum -= weight * u[k][2];
    weights += weight;
  }
  return sum / weights;
}

/// Writes the quarter as a Gmsh 2.2 file: walls below z = 0 and above 0.3 m, so that the tissue keeps its height.
inline void write_solid_mesh(const SolidMesh& m, const std::filesystem::path& file) {
  constexpr double kGrading = 1.7, kHeight = 0.3, kThickness = 0.005;
  std::vector<double> x, z{-kThickness};
  for (int i = 0; i < m.tied; ++i) x.push_back(0.2 * (1 - std::pow(1 - static_cast<double>(i) / m.tied, kGrading)));
  for (int i = 0; i <= m.overhang; ++i)
    x.push_back(0.2 + 0.3 * std::pow(static_cast<double>(i) / m.overhang, kGrading));
  for (int k = 0; k <= m.height; ++k) {
    const double s = 2.0 * k / m.height;
    z.push_back(kHeight * 0.5 * (s <= 1 ? std::pow(s, kGrading) : 2 - std::pow(2 - s, kGrading)));
  }
  z.push_back(kHeight + kThickness);

  std::map<std::array<std::size_t, 3>, std::size_t> numbers;
  std::string nodes, cells;
  std::size_t cell_count = 0;
  const auto number = [&](std::size_t i, std::size_t j, std::size_t k) {
    const auto [entry, is_new] = numbers.try_emplace({i, j, k}, numbers.size() + 1);
    if (is_new) nodes += fmt::format("{} {} {} {}\n", entry->second, x[i], x[j], z[k]);
    return entry->second;
  };
  for (std::size_t k = 0; k + 1 < z.size(); ++k) {
    const bool tissue = k > 0 && k + 2 < z.size();
    const int group = tissue ? 2 : k == 0 ? 1 : 3;
    const std::size_t reach = tissue ? static_cast<std::size_t>(m.tied) : x.size() - 1;
    for (std::size_t j = 0; j < reach; ++j) {
      for (std::size_t i = 0; i < reach; ++i) {
        std::array<std::size_t, 8> c{};
        for (std::size_t v = 0; v < 8; ++v)
          c[v] = number(i + ((v % 4 == 1 || v % 4 == 2) ? 1 : 0), j + v % 4 / 2, k + v / 4);
        const auto add = [&](int type, const std::vector<std::size_t>& corners) {
          cells += fmt::format("{} {} 2 {} {} {}\n", ++cell_count, type, group, group, fmt::join(corners, " "));
        };
        if (!m.tetrahedra) {
          add(5, {c.begin(), c.end()});
          continue;
        }
        constexpr std::array<std::size_t, 7> kRound{1, 2, 3, 7, 4, 5, 1};  // around the diagonal from 0 to 6
        for (std::size_t t = 0; t < 6; ++t) add(4, {c[0], c[kRound[t]], c[kRound[t + 1]], c[6]});
      }
    }
  }
  std::ofstream out(file);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n3 1 \"lower\"\n3 2 \"tissue\"\n3 3 \"upper\"\n"
      << "$EndPhysicalNames\n$Nodes\n"
      << numbers.size() << "\n"
      << nodes << "$EndNodes\n$Elements\n"
      << cell_count << "\n"
      << cells << "$EndElements\n";
}

/// The sag of the solid mesh with elements of order 2.
///
/// A body has one density, here the tissue's; what walls weigh beyond it is a dead force, shared by volume. The scene
/// has no static path that Newton follows (flat walls have no stiffness against their weight), so it settles in damped
/// dynamics: 2.5 s are 30 time constants of what is slowest.
inline Sag sag_of_solid(const SolidMesh& mesh) {
  const TemporaryFolder folder;
  write_solid_mesh(mesh, folder.path / "solid.msh");
  constexpr double kDensity = 1 / (0.4 * 0.4 * 0.3), kGravity = 9.81, kWallVolume = 0.25 * 0.005;
  constexpr double kWeight = 0.25 * 11 * kGravity;
  std::string scene =
      fmt::format(R"(
[world]
gravity = [0, 0, -{}]
over = 1
[bodies.all]
model = "{}"
order = 2
domain = {{ file = "solid.msh" }}
density = {}
material = [{{ where = {{ group = "tissue" }}, use = {{ young = 6000, poisson = 0.3, damping = {{ mass = 100 }} }} }}, {{ use = {{ young = 50000, poisson = 0.3, damping = {{ mass = 100 }} }} }}]
[solver]
kind = "implicit-euler"
time_step = 0.1
duration = 2.5
newton = {{ tolerance = 1e-6 }}
[output]
every = 100
[probes.centre]
body = "all"
at = [0, 0, -0.0025]
quantity = "displacement"
[probes.square]
body = "all"
at = {}
quantity = "displacement"
)",
                  kGravity, mesh.tetrahedra ? "tetrahedra" : "hexahedra", kDensity, points_of_square(0, -0.0025));
  const auto hold = [&](const char* normal, const char* what) {
    scene += fmt::format("[[constraints]]\nbody = \"all\"\nwhere = {{ all_of = [{}] }}\nfix = {}\n", normal, what);
  };
  hold("{ halfspace = { point = [1e-6, 0, 0], normal = [1, 0, 0] } }", "[\"x\"]");
  hold("{ halfspace = { point = [0, 1e-6, 0], normal = [0, 1, 0] } }", "[\"y\"]");
  const char* edge =
      "{ halfspace = { point = [0.499999, 0, 0], normal = [-1, 0, 0] } }, "
      "{ halfspace = { point = [0, 0, 0.299], normal = [0, 0, -1] } }";
  hold(edge, "\"all\"");
  scene += fmt::format("[probes.reaction]\nbody = \"all\"\nwhere = {{ all_of = [{}] }}\nquantity = \"force\"\n", edge);
  for (const char* wall : {"lower", "upper"})
    scene +=
        fmt::format("[[loads]]\nbody = \"all\"\nwhere = {{ group = \"{}\" }}\ntotal_force = [0, 0, {}]\nover = 1\n",
                    wall, -(1000 - kDensity) * kGravity * kWallVolume);
  std::ofstream(folder.path / "solid.toml") << scene;
  const SolvedScene run((folder.path / "solid").string(), {}, 1);
  EXPECT_NEAR(run.vector("reaction")[2], kWeight, 1e-4 * kWeight);
  return {-run.vector("centre")[2], mean_sag(run.vectors("square"))};
}

/// The sag of scenes/hanging_shells.toml; its total reaction must be the weight of all bodies.
inline Sag sag_of_coupled(const Settings& settings = {}) {
  Settings all = settings;
  all.push_back("probes.square={body=\"lower\",quantity=\"displacement\",at=" + points_of_square(-1, 0) + "}");
  const SolvedScene run("hanging_shells", all, 1);
  const double weight = 11 * 9.81;
  EXPECT_NEAR(run.vector("reaction")[2], weight, 1e-6 * weight);
  return {-run.vector("lower_centre")[2], mean_sag(run.vectors("square"))};
}

}  // namespace fascia::test
