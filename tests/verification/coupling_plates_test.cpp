// Tissue between rigid plates, and between organs of other resolutions.
#include "tests/support/cases.hpp"
#include "tests/support/coupled_scene.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace fascia::test::coupling_plates_test {
namespace {

const std::string kTop = "[materials.soft]\nyoung=1e4\npoisson=0.3\n[solver.newton]\ntolerance=1e-10\n";

std::string level(double z) { return box({-1, -1, z - 1e-3}, {2, 2, z + 1e-3}); }

std::string plate(const std::string& name, double low, double high, int n) {
  return fmt::format(
      "[bodies.{}]\nmodel=\"rigid\"\nmass=1\ndomain={{box={{min=[0,0,{}],max=[1,1,{}],cells=[{},{},1]}}}}\n", name, low,
      high, n, n);
}

struct Motion {
  const char* name;
  std::string move;
};
const std::array<Motion, 3> kMotions{{{"stretch", "move={translate=[0,0,0.1]}"},
                                      {"shear", "move={translate=[0.2,0,0]}"},
                                      {"twist", "move={rotate={axis=[0,0,1],angle=0.4,center=[0.5,0.5,0]}}"}}};

std::string about(const std::string& name, const std::string& body, const std::string& where,
                  const std::string& quantity) {
  return probe_of(name, body, where, quantity) + (quantity == "moment" ? "about=[0.5,0.5,1]\n" : "");
}

struct Wrench {
  Vector force, moment;
};

/// 20-node hexahedra between clamped faces.
Wrench clamped(const Motion& m, int n) {
  const TextRun run(kTop + box_body("a", Kind::hexahedra, {0, 0, 0}, {1, 1, 1}, n, "", "density=12\norder=2") +
                    fix("a", level(0)) + fix("a", level(1), m.move) + about("force", "a", level(1), "force") +
                    about("moment", "a", level(1), "moment"));
  return {run.vector("force"), run.vector("moment")};
}

/// @param tissue  what fills the space between the plates
Wrench between(const Motion& m, int n, const std::string& tissue) {
  const TextRun run(kTop + plate("lower", -0.1, 0, n) + plate("upper", 1, 1.1, n) + tissue + fix("lower", "\"all\"") +
                    fix("upper", "\"all\"", m.move) + about("force", "upper", "\"all\"", "force") +
                    about("moment", "upper", "\"all\"", "moment") + probe_of("origin", "upper", "\"all\"", "moment"));
  const Vector pull = run.coupling("tissue", "force", "upper"), turn = run.coupling("tissue", "moment", "upper");
  const Wrench w{run.vector("force"), run.vector("moment")};
  EXPECT_LT(length(pull + w.force), 1e-8 * length(w.force) + 1e-9) << m.name;
  EXPECT_LT(length(turn + run.vector("origin")), 1e-8 * length(turn) + 1e-9) << m.name;
  const Vector other = run.coupling("tissue", "force", "lower");
  EXPECT_LT(length(pull + other), 1e-8 * length(pull) + 1e-9) << m.name;
  return w;
}

std::string grid_tissue(int n) {
  return box_body("tissue", Kind::grid, {0, 0, 0}, {1, 1, 1}, n,
                  fmt::format("{{body=\"lower\",where={}}},{{body=\"upper\",where={}}}", level(0), level(1)));
}
std::string gap_tissue(int n) {
  return fmt::format(
      "[bodies.tissue]\nmodel=\"meshless\"\nmaterial=\"soft\"\ndensity=12\n"
      "domain={{between=[\"lower\",\"upper\"],where={}}}\nframes={{poisson_disk={:.17g}}}\n",
      box({-1, -1, -1e-3}, {2, 2, 1 + 1e-3}), 1.0 / n);
}

/// Largest deviation of force and moment from those of 20-node hexahedra.
TEST(CouplingPlates, ForcesBetweenRigidPlates) {
  std::printf("%-8s %30s %30s   off by: grid 3, 6; between 3, 5\n", "", "force [N]", "moment [N m]");
  for (const Motion& m : kMotions) {
    const Wrench fine = clamped(m, 4);
    const auto off = [&](const Wrench& w) {
      return std::hypot(length(w.force - fine.force), length(w.moment - fine.moment)) /
             std::hypot(length(fine.force), length(fine.moment));
    };
    const double grid[] = {off(between(m, 3, grid_tissue(3))), off(between(m, 6, grid_tissue(6)))};
    const double gap[] = {off(between(m, 3, gap_tissue(3))), off(between(m, 5, gap_tissue(5)))};
    std::printf("%-8s (%8.2f %8.2f %8.2f)   (%8.2f %8.2f %8.2f)   %5.2f %% %5.2f %%  %5.2f %% %5.2f %%\n", m.name,
                fine.force[0], fine.force[1], fine.force[2], fine.moment[0], fine.moment[1], fine.moment[2],
                100 * grid[0], 100 * grid[1], 100 * gap[0], 100 * gap[1]);
    EXPECT_LT(grid[1], 0.03) << m.name;
    EXPECT_LT(gap[1], 0.03) << m.name;
    EXPECT_LT(grid[1], grid[0]) << m.name;
    EXPECT_LT(gap[1], gap[0]) << m.name;
  }
}

// -------------------------------------------------------------------------------------------------- resolutions
std::string wall(const std::string& name, double z, int n) {
  return fmt::format(
      "[bodies.{}]\nmodel=\"shell\"\nthickness=0.05\ndensity=12\nmaterial={{young=1e6,poisson=0.3}}\n"
      "domain={{rectangle={{origin=[0,0,{}],edge_u=[1,0,0],edge_v=[0,1,0],cells=[{},{}]}}}}\n",
      name, z, n, n);
}

/// Displacement of the middle of the upper wall, which a force pulls sideways and up.
Vector pulled(int cells, double spacing) {
  const TextRun run(kTop + wall("lower", 0, cells) + wall("upper", 0.4, cells) +
                    fmt::format("[bodies.tissue]\nmodel=\"meshless\"\nmaterial=\"soft\"\ndensity=12\n"
                                "domain={{between=[\"lower\",\"upper\"],where={}}}\nframes={{poisson_disk={}}}\n",
                                box({-1, -1, -1e-3}, {2, 2, 0.4 + 1e-3}), spacing) +
                    fix("lower", "\"all\"", "fix=\"all\"") +
                    "[[loads]]\nbody=\"upper\"\nwhere=\"all\"\ntotal_force=[500,0,400]\n" +
                    probe_at("middle", "upper", {0.5, 0.5, 0.4}));
  std::printf("  cells %2d, spacing %.4f: (%.5f %.5f %.5f), %d iterations, %d shared, gap %.1e", cells, spacing,
              run.vector("middle")[0], run.vector("middle")[1], run.vector("middle")[2], run.newton_iterations(),
              run.summary()["bodies"]["tissue"]["shared"].get<int>(),
              run.summary()["couplings"]["tissue"]["gap"].get<double>());
  EXPECT_EQ(run.summary()["status"], "converged");
  return run.vector("middle");
}

/// Walls finer than the tissue change little. Where walls are coarser, the tissue's own frames between their nodes
/// follow the wall in place and turn freely, while shared nodes of shells turn with the wall: it is softer.
TEST(CouplingPlates, Resolutions) {
  std::printf("shells, tissue 0.4 thick\n");
  const Vector coarse = pulled(4, 0.25);
  std::printf("\n");
  for (const int cells : full_size() ? std::vector{8, 16} : std::vector{8}) {
    const double change = relative(pulled(cells, 0.25), coarse);
    std::printf(", off by %.2f %%\n", 100 * change);
    EXPECT_LT(change, 0.03);
  }
  if (!full_size()) return;
  std::printf("shells, finer tissue\n");
  const Vector even = pulled(8, 0.125);
  std::printf("\n");
  const double off = relative(pulled(4, 0.125), even);
  std::printf(", off by %.2f %%\n", 100 * off);
  EXPECT_LT(off, 0.08);
}

}  // namespace
}  // namespace fascia::test::coupling_plates_test
