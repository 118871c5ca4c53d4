// Scenes drawn at random, solved with Cholesky, with conjugate gradients and by what runs on a GPU: the same end, or a
// status or a warning that says that there are several.
#include "app/reader/parse.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "fascia/choose_backend.hpp"
#include "gpu/space/device.hpp"
#include "tests/support/cases.hpp"
#include "tests/support/solve_where.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace fascia::test::twins_test {
namespace {

std::string number(double value) {
  char out[32];
  std::snprintf(out, sizeof out, "%.6e", value);
  return out;
}

std::string vector(double x, double y, double z) { return "[" + number(x) + ", " + number(y) + ", " + number(z) + "]"; }

/// A bar of any model, clamped at one end or free, loaded by its weight and at its other end.
struct RandomScene {
  std::string text;

  explicit RandomScene(unsigned seed) : random_(seed) {
    const double length = std::pow(10, uniform(-3, 1)), width = length * uniform(0.05, 0.4);
    const double young = std::pow(10, uniform(3, 10)), density = 1000;
    const int model = pick(7), kind = pick(5);
    const bool thin = model >= 5, free = kind > 0 && pick(4) == 0;
    const bool hyperelastic = !thin && pick(2) == 0;
    text += "[bodies.b]\n" + body(model, length, width) + "density = " + number(density) +
            "\nmaterial = { young = " + number(young) + ", poisson = " + number(pick(2) == 0 ? 0.3 : 0.45) +
            ", law = \"" + (hyperelastic ? "neo-hookean" : "st-venant-kirchhoff") + "\"";
    const double slowest = length * std::sqrt(density / young);  // seconds that a wave takes along the bar
    if (kind > 0 && pick(2) == 0)
      text += ", damping = { mass = " + number(0.1 / slowest) + ", stiffness = " + number(0.01 * slowest) + " }";
    else if (kind > 0 && seed % 3 == 0)
      text += ", viscosity = [{ share = 0.3, time = " + number(slowest) +
              " }, { share = 0.2, time = " + number(30 * slowest) + " }]";
    text += " }\n";
    if (free)
      text += "initial = { velocity = " + directed(0.01 * length / slowest) +
              ", angular_velocity = " + directed(0.1 / slowest) + " }\n";
    else
      text += "[[constraints]]\nbody = \"b\"\nwhere = " + region(-1, 1e-6 * length) + "\nfix = \"all\"\n";
    const double section = thin ? 0.01 * width * width : width * width;
    text += "[world]\ngravity = " + directed(std::pow(10, uniform(-6, -2)) * young / (density * length)) + "\n";
    text += "[[loads]]\nbody = \"b\"\nwhere = " + region((1 - 1e-6) * length, 1.1 * length) +
            "\ntotal_force = " + directed(std::pow(10, uniform(-5, -1.5)) * young * section) + "\n";
    const std::array<const char*, 5> kinds{"static", "implicit-euler", "bdf2", "newmark", "midpoint"};
    text += std::string("[solver]\nkind = \"") + kinds[static_cast<std::size_t>(kind)] + "\"\n";
    if (kind > 0)
      text += "steps = 3\ntime_step = " + number(std::pow(10, uniform(-1, 1.5)) * slowest) + "\n";
    else
      text += "load_steps = " + std::to_string(1 + pick(3)) + "\n";
  }

 private:
  std::string body(int model, double length, double width) {
    const std::string box = "box = { min = [0, 0, 0], max = " + vector(length, width, width);
    const std::string cells = ", cells = [5, 2, 2] } }\n";
    switch (model) {
      case 0:
      case 1:
        return "model = \"tetrahedra\"\norder = " + std::to_string(1 + model) + "\ndomain = { " + box + cells;
      case 2:
        return "model = \"hexahedra\"\norder = " + std::to_string(1 + pick(2)) + "\ndomain = { " + box + cells;
      case 3:
      case 4:
        return "model = \"meshless\"\ndomain = { " + box + " } }\nframes = { grid = [6, 3, 2], kind = \"" +
               (model == 3 ? "rigid" : "affine") + "\" }\n";
      case 5:
        return "model = \"meshless\"\ndomain = { line = { from = [0, 0, 0], to = " + vector(length, 0, 0) +
               " } }\nradius = " + number(0.1 * width) + "\nframes = { grid = [8] }\n";
      default:
        return "model = \"shell\"\ndomain = { rectangle = { origin = [0, 0, 0], edge_u = " + vector(length, 0, 0) +
               ", edge_v = " + vector(0, width, 0) + ", cells = [6, 2] } }\nthickness = " + number(0.05 * width) + "\n";
    }
  }
  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random_); }
  int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  std::string directed(double size) {
    const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1), n = std::sqrt(x * x + y * y + z * z);
    return vector(size * x / n, size * y / n, size * z / n);
  }
  static std::string region(double from, double to) {
    return "{ box = { min = [" + number(from) + ", -1e3, -1e3], max = [" + number(to) + ", 1e3, 1e3] } }";
  }

  std::mt19937 random_;
};

/// It is called converged, and nothing says that there are other ends.
bool claimed(const RunReport& r) {
  return r.status == RunStatus::converged && r.events.empty() && r.indefinite_steps == 0 && r.stability.unstable == 0 &&
         !r.stability.near_limit;
}

Solved solved(const Simulation& s, Where where, LinearMethod linear) {
  SolverSettings settings = settings_of(s.scene.solver);
  settings.linear = linear;
  if (linear == LinearMethod::cg) settings.cg.max_iterations = 20000;
  return solve(s, where, settings);
}

TEST(RandomTwins, EndAlikeOrSayThatThereAreSeveralEnds) {
  std::string reason;
  const bool device = gpu::find_device(reason);
  int compared = 0, warned = 0, failed = 0;
  double worst = 0;
  for (unsigned seed = 1; seed <= static_cast<unsigned>(cases(30)); ++seed) {
    const RandomScene scene(seed);
    const Simulation s = build_simulation(app::parse_scene_text(scene.text, "twins.toml", {}));
    ASSERT_EQ(not_on_gpu(s), "");
    const Solved direct = solved(s, Where::processor, LinearMethod::cholesky);
    std::vector<std::pair<const char*, Solved>> others{{"cg", solved(s, Where::processor, LinearMethod::cg)},
                                                       {"host", solved(s, Where::host, LinearMethod::cg)}};
    if (device) others.emplace_back("device", solved(s, Where::device, LinearMethod::cg));
    for (const auto& [name, other] : others) {
      if (!claimed(direct.report) || !claimed(other.report)) {
        const auto fails = [](const Solved& end) { return end.report.status != RunStatus::converged; };
        ++(fails(direct) || fails(other) ? failed : warned);
        continue;
      }
      ++compared;
      const double error = displacement_difference(other.state, direct.state);
      worst = std::max(worst, error);
      EXPECT_LE(error, 1e-6) << "seed " << seed << ", " << name << "\n" << scene.text;
    }
  }
  std::printf("%d ends compared, displacements differ by %.1e at most; %d warned of, %d not converged\n", compared,
              worst, warned, failed);
  EXPECT_GE(compared, 2 * (warned + failed)) << "most scenes have a single end";
}

/// Where a tangent is indefinite the GPU's direction is that of the host's factor, and the way is the processor's.
TEST(RandomTwins, GoTheProcessorsWayThroughIndefiniteTangents) {
  std::string reason;
  std::vector<std::pair<const char*, Where>> places{{"host", Where::host}};
  if (gpu::find_device(reason)) places.emplace_back("device", Where::device);
  int met = 0, alike = 0;
  for (unsigned seed = 1; seed <= static_cast<unsigned>(cases(30)); ++seed) {
    const RandomScene scene(seed);
    const Simulation s = build_simulation(app::parse_scene_text(scene.text, "twins.toml", {}));
    const Solved direct = solved(s, Where::processor, LinearMethod::cholesky);
    if (direct.report.indefinite_solves == 0) continue;
    for (const auto& [name, where] : places) {
      const Solved other = solved(s, where, LinearMethod::automatic);
      ++met;
      const bool same =
          direct.report.status == other.report.status && displacement_difference(other.state, direct.state) <= 1e-6;
      alike += same ? 1 : 0;
      if (!same) std::printf("seed %u, %s: another end\n", seed, name);
    }
  }
  std::printf("%d of %d ends alike\n", alike, met);
  EXPECT_GE(alike, 0.95 * met);
}

/// Conjugate gradients take hundreds of iterations for a slender body, which a factor solves in less time.
TEST(SlenderTwins, AreLeftToTheHostsFactor) {
  const Simulation s = build_simulation(app::parse_scene_text(R"(
[bodies.b]
model = "meshless"
domain = { line = { from = [0, 0, 0], to = [1, 0, 0] } }
radius = 0.005
frames = { grid = [61] }
density = 1000
material = { young = 1e6, poisson = 0.3 }
[[constraints]]
body = "b"
where = { box = { min = [-1, -1, -1], max = [0.001, 1, 1] } }
fix = "all"
[[loads]]
body = "b"
where = { box = { min = [0.999, -1, -1], max = [2, 1, 1] } }
total_force = [0, 0, 0.0005]
[solver]
kind = "static"
load_steps = 3
)",
                                                              "slender.toml", {}));
  const Solved iterated = solved(s, Where::host, LinearMethod::cg),
               left = solved(s, Where::host, LinearMethod::automatic);
  std::printf("iterations of conjugate gradients: %d, and %d until the host took over\n",
              iterated.report.linear_iterations, left.report.linear_iterations);
  EXPECT_EQ(left.report.status, RunStatus::converged);
  EXPECT_LT(5 * left.report.linear_iterations, iterated.report.linear_iterations);
  EXPECT_LE(displacement_difference(left.state, iterated.state), 1e-6);
  EXPECT_NEAR(left.report.newton_iterations, iterated.report.newton_iterations, 2);
}

}  // namespace
}  // namespace fascia::test::twins_test
