// NAFEMS LE10: a thick elliptic plate under pressure, and the stress at its inner edge from a mesh that misses the peak
// between integration points and nodes.
#include "app/reader/parse.hpp"
#include "app/run/recovery.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "core/base/index.hpp"
#include "core/run/drivers.hpp"
#include "core/solver/mechanical_system.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <string>
#include <vector>

namespace fascia::thick_plate_test {
namespace {

constexpr double kPublished = -5.38e6;  // σyy at D, the upper face's point (2, 0) [Pa]
constexpr double kThickness = 0.6;

/// A quarter of the plate between the ellipses of half axes (2, 1) and (3.25, 2.75), in 20-node hexahedra.
class Quarter {
 public:
  Quarter(int around, int across, int through) : counts_{around, across, through} {
    static constexpr int kEdges[12][2] = {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3},
                                          {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}};  // the order of Gmsh
    for (int i = 0; i < around; ++i)
      for (int j = 0; j < across; ++j)
        for (int k = 0; k < through; ++k) {
          std::array<Place, 8> corner;
          for (std::size_t c = 0; c < 8; ++c)
            corner[c] = {2 * i + (c % 4 > 1 ? 2 : 0), 2 * j + (c % 4 == 1 || c % 4 == 2 ? 2 : 0),
                         2 * k + (c > 3 ? 2 : 0)};
          std::string cell = std::to_string(cells_.size() + 1) + " 17 2 1 1";
          for (const Place& p : corner) cell += " " + std::to_string(node(p));
          for (const auto& edge : kEdges) {
            const Place &a = corner[at(edge[0])], &b = corner[at(edge[1])];
            cell += " " + std::to_string(node({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2}));
          }
          cells_.push_back(cell);
        }
  }
  void write(const std::filesystem::path& file) const {
    std::ofstream out(file);
    out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << points_.size() << "\n";
    for (std::size_t n = 0; n < points_.size(); ++n)
      out << fmt::format("{} {} {} {}\n", n + 1, points_[n][0], points_[n][1], points_[n][2]);
    out << "$EndNodes\n$Elements\n" << cells_.size() << "\n";
    for (const std::string& cell : cells_) out << cell << "\n";
    out << "$EndElements\n";
  }
  std::size_t peak() const { return at(numbers_.at({0, 0, 2 * counts_[2]}) - 1); }
  /// Nodes of the outer face; at half of its height where `middle`.
  std::string outer(bool middle) const {
    std::string list;
    for (const auto& [place, number] : numbers_)
      if (place[1] == 2 * counts_[1] && (!middle || place[2] == counts_[2]))
        list += (list.empty() ? "" : ", ") + std::to_string(number - 1);
    return list;
  }

 private:
  using Place = std::array<int, 3>;

  int node(const Place& place) {
    const auto [entry, added] = numbers_.try_emplace(place, static_cast<int>(points_.size()) + 1);
    if (added) {
      const double t = std::numbers::pi / 2 * place[0] / (2 * counts_[0]), s = place[1] / (2.0 * counts_[1]);
      const bool end = place[0] == 2 * counts_[0];
      points_.push_back({end ? 0 : (2 + 1.25 * s) * std::cos(t), place[0] == 0 ? 0 : (1 + 1.75 * s) * std::sin(t),
                         kThickness * place[2] / (2 * counts_[2])});
    }
    return entry->second;
  }

  Place counts_;
  std::map<Place, int> numbers_;
  std::vector<Vec3d> points_;
  std::vector<std::string> cells_;
};

std::string scene_of(const Quarter& plate, const std::filesystem::path& mesh) {
  const auto hold = [](const std::string& where, const std::string& axes) {
    return fmt::format("[[constraints]]\nbody = \"plate\"\nwhere = {{ {} }}\nfix = [{}]\n", where, axes);
  };
  return fmt::format(
             "[bodies.plate]\nmodel = \"hexahedra\"\norder = 2\nformulation = \"linear\"\ndensity = 7800\n"
             "domain = {{ file = \"{}\" }}\nmaterial = {{ young = \"210 GPa\", poisson = 0.3 }}\n"
             "[[loads]]\nbody = \"plate\"\nwhere = {{ box = {{ min = [-1, -1, 0.599], max = [9, 9, 0.601] }} }}\n"
             "pressure = \"1 MPa\"\n[solver]\nkind = \"static\"\n",
             mesh.string()) +
         hold("box = { min = [-1, -1e-6, -1], max = [9, 1e-6, 1] }", "\"y\"") +
         hold("box = { min = [-1e-6, -1, -1], max = [1e-6, 9, 1] }", "\"x\"") +
         hold("ids = [" + plate.outer(false) + "]", "\"x\", \"y\"") +
         hold("ids = [" + plate.outer(true) + "]", "\"z\"");
}

struct Peak {
  double recovered = 0, of_element = 0, averaged = 0;  ///< σyy as a .vtu has it, as a probe, as a plain average [Pa]
};

Peak peak_of(int around, int across, int through) {
  const std::filesystem::path mesh =
      std::filesystem::temp_directory_path() / fmt::format("fascia_le10_{}_{}.msh", ::getpid(), around);
  const Quarter plate(around, across, through);
  plate.write(mesh);
  const Simulation s = build_simulation(app::parse_scene_text(scene_of(plate, mesh), "plate.toml", {}));
  std::filesystem::remove(mesh);
  const SolverSettings settings = settings_of(s.scene.solver);
  ThreadPool pool(1);
  MechanicalSystem system(s.model, pool, settings);
  State state = s.initial;
  const RunReport run = run_statics(system, state, [&](double load) { return s.factors(load); }, settings, {}, {});
  EXPECT_EQ(run.status, RunStatus::converged) << run.message;

  const SimulatedBody& body = s.bodies[0];
  const std::vector<PointTensors> points = body.body->tensors(state);
  const std::size_t d = plate.peak();
  Peak peak;
  peak.recovered = app::NodalRecovery(body).at_nodes(points, pool)[d].stress(1, 1);
  double nearest = 1e9, volume = 0;
  std::size_t at_d = 0;
  for (std::size_t q = 0; q < points.size(); ++q) {
    const double distance = norm(body.body->points()[q].X - body.nodes[d]);
    if (distance < nearest) at_d = q, nearest = distance;
    const Attachment a = body.body->attach_point(q);
    for (std::size_t k = 0; k < a.nodes.size(); ++k) {
      if (body.index_of(a.nodes[k]) != d) continue;
      const double share = body.body->points()[q].volume * std::max(a.influences[k].w, 1e-3);
      volume += share;
      peak.averaged += share * points[q].stress(1, 1);
    }
  }
  peak.averaged /= volume;
  peak.of_element = body.body->tensors_at(body.body->attach(body.nodes[d]), at_d, state).stress(1, 1);
  return peak;
}

TEST(ThickPlate, StressAtTheInnerEdge) {
  std::printf(
      "LE10, stress yy at D, published %.2f MPa\ncells       recovered  error  element  error  averaged  error\n",
      kPublished / 1e6);
  double before = 1;
  for (const auto& [around, across, through] : {std::array{6, 4, 2}, std::array{12, 8, 4}}) {
    const Peak p = peak_of(around, across, through);
    const auto percent = [](double value) { return 100 * (value / kPublished - 1); };
    std::printf("%2d x %d x %d  %9.3f  %4.1f %%  %7.3f  %4.1f %%  %8.3f  %4.1f %%\n", around, across, through,
                p.recovered / 1e6, percent(p.recovered), p.of_element / 1e6, percent(p.of_element), p.averaged / 1e6,
                percent(p.averaged));
    const double error = std::abs(p.recovered / kPublished - 1);
    EXPECT_LT(error, 0.5 * std::abs(p.averaged / kPublished - 1));
    EXPECT_LT(error, before);
    before = error;
  }
  EXPECT_LT(before, 0.03);
}

}  // namespace
}  // namespace fascia::thick_plate_test
