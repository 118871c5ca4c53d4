// Scattered bodies that are embedded or welded: their material is tied, since their frames are not where it is.
#include "tests/support/coupled_scene.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

namespace fascia::test::coupling_ties_test {
namespace {

std::string at_x(double x) { return box({x - 1e-4, -9, -9}, {x + 1e-4, 9, 9}); }

/// Two bars of 1 m in a row, the second of scattered frames, as far apart as the bars are thick by 3/4.
std::string bars(const std::string& host, const std::string& rest) {
  return "[bodies.host]\n" + host +
         "density=1000\nmaterial={young=1e6,poisson=0}\n"
         "[bodies.rider]\nmodel=\"meshless\"\ndomain={box={min=[1,0,0],max=[2,0.2,0.2]}}\ndensity=1000\n"
         "material={young=5e5,poisson=0}\nframes={poisson_disk=0.15}\n" +
         coupling("joint", "embed", "rider", at_x(1), "to=\"host\"") + rest;
}

const std::string kBox = "domain={box={min=[0,0,0],max=[1,0.2,0.2]";
const std::string kHosts[] = {"model=\"hexahedra\"\n" + kBox + ",cells=[4,2,2]}}\n",
                              "model=\"tetrahedra\"\norder=2\n" + kBox + ",cells=[4,2,2]}}\n",
                              "model=\"meshless\"\n" + kBox + "}}\nframes={grid=[5,3,3]}\n",
                              "model=\"meshless\"\n" + kBox + "}}\nframes={poisson_disk=0.1}\n"};

/// 0.4 N stretch the first bar by 10 micrometres and the second by 20.
TEST(CouplingTies, BarsInARow) {
  for (const std::string& host : kHosts) {
    const TextRun run(bars(host, fix("host", at_x(0)) + "[[loads]]\nbody=\"rider\"\nwhere=" + at_x(2) +
                                     "\ntotal_force=[0.4,0,0]\n" + probe_at("end", "rider", {2, 0.1, 0.1}) +
                                     probe_at("joint", "host", {1, 0.1, 0.1})));
    const double end = run.vector("end")[0], joint = run.vector("joint")[0];
    const double gap = run.summary()["couplings"]["joint"]["gap"];
    const Vector force = run.coupling("joint", "force"), moment = run.coupling("joint", "moment");
    std::printf("%-50s end %.4e of 3e-5 m, gap %.1e of the joint's motion, force %.12f N\n",
                host.substr(0, host.find('\n')).c_str(), end, gap / joint, force[0]);
    EXPECT_NEAR(end, 3e-5, 0.03 * 3e-5);
    EXPECT_NEAR(joint, 1e-5, 0.03 * 1e-5);
    EXPECT_GT(gap, 0);
    EXPECT_LT(gap, 1e-3 * joint);
    EXPECT_LT(relative(force, {-0.4, 0, 0}), 1e-8);
    EXPECT_LT(length(moment - Vector{0, -0.04, 0.04}), 1e-4 * 0.04);  // about the origin
  }
}

/// A rod of 1 m and a radius of 1 cm on a rigid body, that one thousandth of a newton bends: F L³ / (3 E I).
TEST(CouplingTies, AWeldedRodBends) {
  const std::string tool =
      "[bodies.tool]\nmodel=\"rigid\"\ndomain={box={min=[-0.1,-0.05,-0.05],max=[0,0.05,0.05]}}\nmass=1\n";
  const TextRun run(
      tool +
      "[bodies.rod]\nmodel=\"meshless\"\ndomain={line={from=[0,0,0],to=[1,0,0]}}\nradius=0.01\ndensity=1000\n"
      "material={young=1e7,poisson=0.3}\nframes={poisson_disk=0.06}\n" +
      coupling("root", "weld", "rod", at_x(0), "to=\"tool\"") + fix("tool", "\"all\"") +
      "[[loads]]\nbody=\"rod\"\nwhere=" + at_x(1) + "\ntotal_force=[0,0,-0.001]\n" + probe_at("end", "rod", {1, 0, 0}));
  const double inertia = std::numbers::pi * 1e-8 / 4, expected = -0.001 / (3 * 1e7 * inertia);
  std::printf("a welded rod: %.6e m of %.6e\n", run.vector("end")[2], expected);
  EXPECT_NEAR(run.vector("end")[2], expected, 1e-3 * -expected);
  EXPECT_NEAR(run.coupling("root", "moment")[1], -0.001, 1e-4 * 0.001);  // the end has come nearer
}

/// One frame of a block is welded to a tool that turns by 90 degrees: the block turns with it and stores nothing.
TEST(CouplingTies, AWeldedBlockTurnsWithItsHost) {
  const TextRun run(
      "[bodies.tool]\nmodel=\"rigid\"\ndomain={box={min=[-0.1,-0.05,-0.05],max=[0,0.05,0.05]}}\nmass=1\n"
      "[bodies.block]\nmodel=\"meshless\"\ndomain={box={min=[0,-0.05,-0.05],max=[0.5,0.05,0.05]}}\n"
      "density=1000\nmaterial={young=1e6,poisson=0.3}\nframes={poisson_disk=0.06}\n" +
      coupling("grip", "weld", "block", "{nearest=[0,0,0]}", "to=\"tool\"") +
      fix("tool", "\"all\"", "move={rotate={axis=[0,0,1],angle=\"90 deg\",center=[0,0,0]}}") +
      probe_at("end", "block", {0.5, 0, 0}) + "[probes.energy]\nbody=\"block\"\nquantity=\"energy\"\n");
  const Vector end = run.vector("end");
  std::printf("turned: off by %.1e m, %.1e J\n", length(end - Vector{-0.5, 0.5, 0}), run.number("energy"));
  EXPECT_LT(length(end - Vector{-0.5, 0.5, 0}), 1e-9);
  EXPECT_LT(run.number("energy"), 1e-12);
}

/// Ties push both bodies alike: momentum and angular momentum of free flight stay.
TEST(CouplingTies, FreeFlight) {
  for (const std::string kind : {"midpoint", "explicit"}) {
    const std::string spin = "initial={velocity=[0.1,0.2,0],angular_velocity=[0.3,1,2],about=[1,0.1,0.1]}\n";
    std::string text =
        bars(kHosts[0] + spin, "[solver]\nkind=\"" + kind + "\"\n" +
                                   (kind == "explicit" ? "time_step=\"auto\"\nduration=0.05\n"
                                                       : "time_step=0.005\nsteps=20\nnewton.tolerance=1e-12\n") +
                                   "[probes.a]\nquantity=\"momentum\"\n[probes.b]\nquantity=\"angular_momentum\"\n"
                                   "[output]\nevery_steps=1\n");
    text.insert(text.find("[bodies.rider]\n") + 15, spin);
    const auto rows = TextRun(text).history();
    ASSERT_GT(rows.size(), 10u);
    for (const std::size_t first : {1u, 4u}) {
      double largest = 0, size = 0;
      for (std::size_t k = first; k < first + 3; ++k) size = std::hypot(size, rows[0][k]);
      for (const auto& row : rows)
        for (std::size_t k = first; k < first + 3; ++k) largest = std::max(largest, std::abs(row[k] - rows[0][k]));
      std::printf("%s, %s: off by %.1e\n", kind.c_str(), first == 1 ? "momentum" : "angular momentum", largest / size);
      EXPECT_LT(largest, 1e-9 * size) << kind;
    }
  }
}

}  // namespace
}  // namespace fascia::test::coupling_ties_test
