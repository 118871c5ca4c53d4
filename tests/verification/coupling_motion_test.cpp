// Momenta and energy of coupled bodies in free flight, springs, and surfaces that ride on others.
#include "tests/support/coupled_scene.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace fascia::test::coupling_motion_test {
namespace {

std::string at_x(double x) { return box({x - 1e-3, -1, -1}, {x + 1e-3, 2, 2}); }

/// Tetrahedra, tissue that shares their vertices, those of a rigid body and a shell's nodes, a fin welded to the rigid
/// body and a surface embedded in the tetrahedra; they turn, and the tetrahedra and the bone move apart.
std::string flight(const std::string& solver) {
  const auto spin = [](double vx) {
    return fmt::format("initial={{velocity=[{},0.2,0],angular_velocity=[0.3,1,2],about=[1.5,0.5,0.5]}}\n", vx);
  };
  return "[materials.soft]\nyoung=1e4\npoisson=0.3\n[solver]\n" + solver +
         box_body("organ", Kind::tetrahedra, {0, 0, 0}, {1, 1, 1}, 2) + spin(-0.3) +
         "[bodies.bone]\nmodel=\"rigid\"\nmass=20\ndomain={box={min=[2,0,0],max=[3,1,1],cells=[1,2,2]}}\n" + spin(0.5) +
         "[bodies.skin]\nmodel=\"shell\"\ndensity=50\nthickness=0.05\nmaterial={young=1e5,poisson=0.3}\n"
         "domain={rectangle={origin=[1.25,0,1],edge_u=[0.5,0,0],edge_v=[0,1,0],cells=[2,2]}}\n" +
         spin(0.1) +
         "[bodies.fin]\nmodel=\"shell\"\ndensity=50\nthickness=0.05\nmaterial={young=1e5,poisson=0.3}\n"
         "domain={rectangle={origin=[3,0,0.5],edge_u=[0.6,0,0],edge_v=[0,1,0],cells=[2,2]}}\n" +
         spin(0.5) +
         "[bodies.tissue]\nmodel=\"meshless\"\nmaterial=\"soft\"\ndensity=12\n"
         "domain={box={min=[1,0,0],max=[2,1,1]}}\n"
         "frames={grid=[5,3,3],share=[{body=\"organ\",where=" +
         at_x(1) + "},{body=\"bone\",where=" + at_x(2) + "},{body=\"skin\"}]}\n" + spin(0.1) +
         "[bodies.paint]\nmodel=\"surface\"\n"
         "domain={rectangle={origin=[0,0,1],edge_u=[1,0,0],edge_v=[0,1,0],cells=[3,3]}}\n" +
         coupling("ride", "embed", "paint", "\"all\"", "to=\"organ\"") +
         coupling("root", "weld", "fin", at_x(3), "to=\"bone\"") +
         "[probes.a]\nquantity=\"momentum\"\n[probes.b]\nquantity=\"angular_momentum\"\n"
         "[probes.c]\nquantity=\"total_energy\"\n[probes.d]\nquantity=\"energy\"\n[output]\nevery_steps=1\n";
}

TEST(CouplingMotion, FreeFlight) {
  const auto drift = [](const std::vector<std::vector<double>>& rows, std::size_t first) {
    double largest = 0, size = 0;
    for (std::size_t k = first; k < first + 3; ++k) size = std::hypot(size, rows[0][k]);
    for (const auto& row : rows)
      for (std::size_t k = first; k < first + 3; ++k) largest = std::max(largest, std::abs(row[k] - rows[0][k]) / size);
    return largest;
  };
  std::printf("%-16s %10s %10s %12s %12s %10s\n", "", "momentum", "angular", "energy, max", "min", "elastic");
  for (const std::string kind : {"implicit-euler", "midpoint", "explicit"}) {
    const std::string steps = kind == "explicit" ? "time_step=\"auto\"\nduration=0.4\n"
                                                 : "time_step=0.01\nsteps=40\nnewton.tolerance=1e-12\n";
    const TextRun run(flight("kind=\"" + kind + "\"\n" + steps));
    const auto rows = run.history();
    ASSERT_GT(rows.size(), 10u);
    double gain = -1, low = 0, high = 0, elastic = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      gain = std::max(gain, (rows[i][7] - rows[i - 1][7]) / rows[0][7]);
      high = std::max(high, rows[i][7] / rows[0][7] - 1);
      low = std::min(low, rows[i][7] / rows[0][7] - 1);
      elastic = std::max(elastic, rows[i][8] / rows[0][7]);
    }
    std::printf("%-16s %10.1e %10.1e %12.1e %12.1e %10.3f  (%zu rows, gain %.1e)\n", kind.c_str(), drift(rows, 1),
                drift(rows, 4), high, low, elastic, rows.size(), gain);
    EXPECT_LT(drift(rows, 1), 1e-9) << kind;
    if (kind == "implicit-euler") {
      EXPECT_LT(gain, 1e-12);
    } else {
      EXPECT_LT(drift(rows, 4), 1e-9) << kind;
      EXPECT_LT(high - low, 0.02) << kind;
    }
  }
}

// ------------------------------------------------------------------------------------------------------- springs
TEST(CouplingMotion, Springs) {
  const auto hung = [](const std::string& spring) {
    return "[world]\ngravity=[0,0,-10]\n[bodies.ball]\nmodel=\"rigid\"\nmass=2\n"
           "domain={sphere={center=[0,0,0],radius=0.1,cells=[8]}}\n" +
           fix("ball", "\"all\"", "fix=[\"x\",\"y\",\"rx\",\"ry\",\"rz\"]") +
           coupling("rope", "spring", "ball", "\"all\"", "stiffness=400\n" + spring) +
           "[solver.newton]\ntolerance=1e-12\n" + probe_at("u", "ball", {0, 0, 0});
  };
  for (const std::string spring :
       {"point=[0,0,1]", "point=[0.3,0,1]\ndirection=[0,0,2]", "point=[0,0,1]\ndirection=[0,0,-1]"}) {
    const TextRun run(hung(spring));
    const double u = run.vector("u")[2], force = run.coupling("rope", "force")[2],
                 energy = run.summary()["couplings"]["rope"]["energy"];
    std::printf("spring %s: u %.12f, force %.10f N, energy %.12f J\n", spring.substr(0, 15).c_str(), u, force, energy);
    EXPECT_NEAR(u, -0.05, 1e-9 * 0.05);
    EXPECT_NEAR(force, 20, 1e-9 * 20);
    EXPECT_NEAR(energy, 0.5 * 400 * 0.05 * 0.05, 1e-9);
  }
}

// ------------------------------------------------------------------------------------------------------- surfaces
TEST(CouplingMotion, ASurfaceRides) {
  const std::string top = "{box={min=[-1,-1,0.999],max=[3,2,1.001]}}";
  const auto loaded = [&](Kind kind, const std::string& body, const std::string& load) {
    return TextRun("[materials.soft]\nyoung=1e4\npoisson=0.3\n[solver.newton]\ntolerance=1e-12\n" +
                   box_body("host", kind, {0, 0, 0}, {2, 1, 1}, 3) + fix("host", at_x(0)) +
                   "[bodies.skin]\nmodel=\"surface\"\n"
                   "domain={rectangle={origin=[0,0,1],edge_u=[2,0,0],edge_v=[0,1,0],cells=[10,5]}}\n" +
                   coupling("ride", "embed", "skin", "\"all\"", "to=\"host\"") +
                   fmt::format("[[loads]]\nbody=\"{}\"\nwhere={}\n{}\n", body, top, load) +
                   probe_of("force", "host", at_x(0), "force") + probe_at("a", "host", {1.8, 0.4, 1}) +
                   probe_at("b", "skin", {1.8, 0.4, 1}) + probe_at("tip", "host", {2, 0.5, 0.5}));
  };
  for (const Kind kind : {Kind::grid, Kind::scattered, Kind::tetrahedra, Kind::hexahedra}) {
    const TextRun dead(loaded(kind, "skin", "traction=[10,20,-150]")),
        dead_host(loaded(kind, "host", "traction=[10,20,-150]")), pressed(loaded(kind, "skin", "pressure=150")),
        pressed_host(loaded(kind, "host", "pressure=150"));
    const double ride =
        std::max(relative(dead.vector("a"), dead.vector("b")), relative(pressed.vector("a"), pressed.vector("b")));
    const double resultant = length(dead.vector("force") + Vector{10, 20, -150} * 2) / (2 * 150);
    std::printf(
        "%-12s rides to %.1e, resultant to %.1e; tip: traction %+.2f %%, pressure %+.2f %% (%.4f m)\n", name_of(kind),
        ride, resultant, 100 * (length(dead.vector("tip")) / length(dead_host.vector("tip")) - 1),
        100 * (length(pressed.vector("tip")) / length(pressed_host.vector("tip")) - 1), length(dead.vector("tip")));
    EXPECT_LT(ride, 1e-12);
    EXPECT_LT(resultant, 1e-9);
  }
}

}  // namespace
}  // namespace fascia::test::coupling_motion_test
