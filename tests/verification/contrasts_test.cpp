// Bodies of two materials whose stiffness differs by up to 2e8, drawn at random: whatever is called converged is in
// equilibrium, and nearly all are.
#include "app/reader/parse.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "core/run/drivers.hpp"
#include "core/solver/mechanical_system.hpp"
#include "tests/support/cases.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

namespace fascia::contrasts_test {
namespace {

/// A bar of two halves that hangs from one end, so that it has an equilibrium whatever its materials are.
struct HangingBar {
  std::string text;
  std::string said;  ///< in a line

  explicit HangingBar(unsigned seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double from, double to) {
      return std::uniform_real_distribution<double>(from, to)(random);
    };
    const auto pick = [&](int count) { return std::uniform_int_distribution<int>(0, count - 1)(random); };
    const double length = std::pow(10, uniform(-3, 1)), width = length * uniform(0.1, 0.5);
    const std::array<double, 2> young{std::pow(10, uniform(2, 10.3)), std::pow(10, uniform(2, 10.3))};
    const double softest = std::min(young[0], young[1]);
    const double gravity = std::pow(10, uniform(-4, -1.3)) * softest / (1000 * length);
    const int model = pick(5), law = pick(2), solver = pick(2);
    const bool grid = model == 4;
    const char* names[] = {"tetrahedra", "tetrahedra", "hexahedra", "hexahedra", "meshless"};
    const auto box = [](double from, double to) {
      return "{ box = { min = [" + number(from) + ", -1e3, -1e3], max = [" + number(to) + ", 1e3, 1e3] } }";
    };
    text = "[world]\ngravity = [" + number(gravity) + ", 0, 0]\n";
    for (const int m : {0, 1})
      text += "[materials.m" + std::to_string(m) + "]\nyoung = " + number(young[static_cast<std::size_t>(m)]) +
              "\npoisson = 0.3\nlaw = \"" + (law == 0 ? "st-venant-kirchhoff" : "neo-hookean") + "\"\n";
    text += std::string("[bodies.b]\nmodel = \"") + names[model] + "\"\ndensity = 1000\n";
    if (!grid) text += "order = " + std::to_string(1 + model % 2) + "\n";
    text += "domain = { box = { min = [0, 0, 0], max = [" + number(length) + ", " + number(width) + ", " +
            number(width) + "]" + (grid ? "" : ", cells = [8, 2, 2]") + " } }\n";
    if (grid) text += "frames = { grid = [9, 3, 3] }\n";
    text += "material = [{ where = " + box(-1, 0.5 * length) + ", use = \"m0\" }, { use = \"m1\" }]\n";
    text += "[[constraints]]\nbody = \"b\"\nwhere = " + box(-1, 1e-6 * length) + "\nfix = \"all\"\n";
    text += std::string("[solver]\nkind = \"static\"\nlinear = { kind = \"") + (solver == 0 ? "cholesky" : "cg") +
            "\", max_iterations = 20000 }\n";
    said = std::string(names[model]) + (grid ? "" : std::to_string(1 + model % 2)) + ", " + (law == 0 ? "svk" : "nh") +
           ", " + (solver == 0 ? "cholesky" : "cg") + ", E " + number(young[0]) + " and " + number(young[1]) +
           " Pa, length " + number(length) + " m";
  }
  static std::string number(double value) {
    char out[32];
    std::snprintf(out, sizeof out, "%.6e", value);
    return out;
  }
};

TEST(RandomContrasts, AreInEquilibriumWhereTheyConverge) {
  const int kCases = test::cases(100);
  int converged = 0, iterations = 0;
  double worst = 0;
  for (int seed = 1; seed <= kCases; ++seed) {
    const HangingBar bar(static_cast<unsigned>(seed));
    Simulation simulation = build_simulation(app::parse_scene_text(bar.text, "bar.toml", {}));
    ThreadPool pool(1);
    const SolverSettings settings = settings_of(simulation.scene.solver);
    MechanicalSystem system(simulation.model, pool, settings);
    State state = simulation.initial;
    const RunReport report =
        run_statics(system, state, [&](double load) { return simulation.factors(load); }, settings, {}, {});
    iterations += report.newton_iterations;
    if (report.status != RunStatus::converged) {
      std::printf("not converged: seed %d, %s: %s\n", seed, bar.said.c_str(), report.message.c_str());
      continue;
    }
    ++converged;
    double weight = 0, reaction = 0;
    for (const DeadLoad& load : simulation.model.loads)
      for (const NodeLoad& n : load.nodes) weight += n.force[0];
    for (const FrameConstraint& c : simulation.model.constraints)
      reaction -= system.gradient()[static_cast<std::size_t>(simulation.model.points.dofs.begin(c.node))];
    const double error = std::abs(reaction - weight) / weight;
    worst = std::max(worst, error);
    EXPECT_LE(error, 1e-4) << "seed " << seed << ", " << bar.said;
  }
  std::printf("%d of %d converged, %.1f Newton iterations each; weight and reaction differ by %.1e at most\n",
              converged, kCases, static_cast<double>(iterations) / kCases, worst);
  EXPECT_GE(converged, 0.99 * kCases);
}

}  // namespace
}  // namespace fascia::contrasts_test
