// Fibres and active stresses: what is read, what does not go together, and what a run does with them.
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/matter.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/run/drivers.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "core/run/path_following.hpp"
#include "core/solver/verdict.hpp"
#include "tests/unit/app/scene_text.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fascia::app::muscle_test {
namespace {

using namespace test;

/// The messages of a material's keys beside young and poisson, from column 49 of line 8 on.
std::string errors_of_muscle(const std::string& keys) {
  std::string text = mesh_body("tetrahedra", meshed_box);
  const std::string named = "material = \"soft\"";
  return errors_of(
      text.replace(text.rfind(named), named.size(), "material = { young = 1, poisson = 0.3, " + keys + "}"));
}

TEST(Muscle, WrongKeysAreNamed) {
  const std::string along = "fibres = [{ direction = [1, 0, 0] }], ";
  EXPECT_EQ(errors_of_muscle(along + "active = { stress = \"30 kPa\", over = 2 }"), "");
  EXPECT_EQ(errors_of_muscle("active = { stress = 1 }"),
            "a.toml:8:12: bodies.block.material.fibres: is missing; active needs fibres, such as fibres = [{ direction "
            "= [1, 0, 0] }]");
  EXPECT_EQ(errors_of_muscle("fibres = [{ direction = [1, 0, 0] }]"),
            "a.toml:8:49: bodies.block.material.fibres: is used only beside active; remove it");
  EXPECT_EQ(errors_of_muscle("fibres = [{ direction = [0, 0, 0] }], active = { stress = 1 }"),
            "a.toml:8:64: bodies.block.material.fibres[0].direction: has no direction; must be a vector of a length "
            "other than 0");
  EXPECT_EQ(errors_of_muscle("fibres = [{ cylindrical = { axis = [0, 0, 0] } }], active = { stress = 1 }"),
            "a.toml:8:75: bodies.block.material.fibres[0].cylindrical.axis: has no direction; must be a vector of a "
            "length other than 0");
  EXPECT_EQ(errors_of_muscle("fibres = [{}], active = { stress = 1 }"),
            "a.toml:8:50: bodies.block.material.fibres[0]: direction or cylindrical is missing; give exactly one");
  EXPECT_EQ(errors_of_muscle(along + "active = { stress = 1, direction = 1 }"),
            "a.toml:8:113: bodies.block.material.active.direction: 1 is no family of fibres; must be 0");
  EXPECT_EQ(errors_of_muscle(along + "active = { stress = 0 }"),
            "a.toml:8:98: bodies.block.material.active.stress: 0 is out of range; must be above 0");
  EXPECT_EQ(errors_of_muscle(along + "active = { stress = 1, stres = 2 }"),
            "a.toml:8:101: bodies.block.material.active.stres: is no known key; did you mean \"stress\"?");
}

TEST(Muscle, ShellsTakeNone) {
  std::string text =
      shell_body("rectangle = { origin = [0, 0, 0], edge_u = [2, 0, 0], edge_v = [0, 1, 0], cells = [4, 2] }",
                 "thickness = 0.1\n");
  text.replace(text.find("poisson = 0.3"), 13,
               "poisson = 0.3\nfibres = [{ direction = [1, 0, 0] }]\nactive = { stress = 1 }");
  EXPECT_NE(errors_of(text).find("\"soft\" has an active stress, which shells do not take; remove active, or take a "
                                 "meshless sheet or elements"),
            std::string::npos)
      << errors_of(text);
}

/// The beam, which is 4 m long and of 40 kPa, with fibres that pull.
std::string pulling_beam(const std::string& fibres, const std::string& active, const std::string& solver) {
  return beam_with("poisson = 0.3", "poisson = 0.3\nfibres = [" + fibres + "]\nactive = { " + active + " }") +
         "[[constraints]]\nbody = \"beam\"\nwhere = { box = { min = [-1, -1, -1], max = [0.01, 9, 9] } }\n"
         "fix = [\"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\"]\n[solver]\n" +
         solver;
}

Simulation built(const std::string& text) { return build_simulation(parse(text)); }

TEST(Muscle, FibresWindAboutAnAxis) {
  const Fibres rings{{}, WoundFibres{{{1, 1, 0}}, {{0, 0, 1}}, 0}};
  EXPECT_NEAR(norm(fibre_direction(rings, {{3, 1, 7}}) - Vec3d{{0, 1, 0}}), 0, 1e-15);
  EXPECT_NEAR(norm(fibre_direction(rings, {{1, 0.5, 7}}) - Vec3d{{1, 0, 0}}), 0, 1e-15);
  const Fibres helix{{}, WoundFibres{{}, {{1, 0, 0}}, std::numbers::pi / 6}};
  EXPECT_NEAR(norm(fibre_direction(helix, {{5, 2, 0}}) - Vec3d{{0.5, 0, std::sqrt(0.75)}}), 0, 1e-15);
  EXPECT_THROW(fibre_direction(rings, {{1, 1, 5}}), SceneError);
  const Fibres along{{}, WoundFibres{{}, {{0, 1, 0}}, -std::numbers::pi / 2}};
  EXPECT_EQ(fibre_direction(along, {{0, 5, 0}}), (Vec3d{{0, -1, 0}}));
}

/// Directions are those at integration points: an element around the axis has none on it.
TEST(Muscle, RingsAboutTheMiddleOfAnElement) {
  const std::string text = R"([bodies.block]
model = "hexahedra"
domain = { box = { min = [-1, -1, 0], max = [1, 1, 1], cells = [3, 3, 1] } }
order = 1
mass = 1
material = { young = 1, poisson = 0.3, fibres = [{ cylindrical = { axis = [0, 0, 1] } }], active = { stress = 0.1 } }
constraints = [{ body = "block", where = { box = { min = [-9, -9, -1], max = [9, 9, 0.01] } }, fix = "all" }]
)";
  const Simulation s =
      built("constraints" + text.substr(text.find(" = [{ body")) + text.substr(0, text.find("constraints")));
  for (const BodyPoint& p : s.bodies[0].body->points()) {
    ASSERT_TRUE(p.active);
    EXPECT_NEAR(norm(p.active->S * Vec3d{{p.X[0], p.X[1], 0}}), 0, 1e-15);
    EXPECT_NEAR(trace(p.active->S), 0.1, 1e-15);
  }
}

TEST(Muscle, AcrossASheetItDoesNothing) {
  const auto is_told = [](const std::string& direction) {
    std::string text = thin_body(rectangle, "thickness = 0.1\nframes = { grid = [5, 3] }\n");
    text.replace(text.find("poisson = 0.3"), 13,
                 "poisson = 0.3\nfibres = [{ direction = " + direction + " }]\nactive = { stress = 0.1 }");
    const Simulation s =
        built(text +
              "[[constraints]]\nbody = \"skin\"\nwhere = { box = { min = [-1, -1, -1], max = [0.01, 9, 9] } }\n"
              "fix = \"all\"\n");
    const std::vector<std::string>& messages = s.bodies[0].body->messages();
    return std::any_of(messages.begin(), messages.end(), [](const std::string& message) {
      return message.find("fibres across the sheet") != std::string::npos;
    });
  };
  EXPECT_FALSE(is_told("[1, 0, 1]"));
  EXPECT_TRUE(is_told("[0, 0, 1]"));
}

TEST(Muscle, ExplicitStepsRefuseIt) {
  try {
    built(
        pulling_beam("{ direction = [1, 0, 0] }", "stress = 1", "kind = \"explicit\"\ntime_step = 1e-4\nsteps = 1\n"));
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("materials.soft.active: is not available with explicit steps"),
              std::string::npos)
        << error.what();
  }
  const Simulation s = built(pulling_beam("{ direction = [1, 0, 0] }", "stress = 1", "kind = \"static\"\n"));
  EXPECT_THROW(refuse_active_stress(s.model), InputError);
}

/// A state's stress is that of the factor that it was reached with; at the start that of time 0.
TEST(Muscle, AStateKnowsItsFactors) {
  const Simulation at_once = built(pulling_beam("{ direction = [1, 0, 0] }", "stress = \"1 kPa\"",
                                                "kind = \"implicit-euler\"\ntime_step = 1\nsteps = 1\n"));
  EXPECT_EQ(at_once.initial.factors, std::vector<double>{1});
  EXPECT_NEAR(at_once.bodies[0].body->tensors(at_once.initial)[0].stress(0, 0), 1000, 1e-9);
  const Simulation grows =
      built(pulling_beam("{ direction = [1, 0, 0] }", "stress = \"1 kPa\"", "kind = \"static\"\n"));
  EXPECT_EQ(grows.initial.factors, std::vector<double>{0});
  EXPECT_EQ(grows.bodies[0].body->tensors(grows.initial)[0].stress(0, 0), 0);
}

/// What muscle pulls with shows in reactions alone, as a boundary's motion does: these are what a residual is held
/// against.
void expect_reactions_to_count(const char* model, const char* cells) {
  const auto block = [&](const char* name, int from, const char* more) {
    return fmt::format(
        "[bodies.{}]\n{}domain = {{ box = {{ min = [{}, 0, 0], max = [{}, 1, 1]{} }} }}\nmass = 1\n"
        "material = {{ young = 1, poisson = 0.3{} }}\n",
        name, model, from, from + 1, cells, more);
  };
  const Simulation s = built(block("passive", 0, "") +
                             block("muscle", 5, ", fibres = [{ direction = [1, 0, 0] }], active = { stress = 0.1 }") +
                             "[solver]\nkind = \"implicit-euler\"\ntime_step = 1\nsteps = 1\n");
  const std::vector<char> driven = driven_parts(s.model);
  const auto part = [&](std::size_t body) {
    return at(s.model.points.node_part[at(s.bodies[body].body->first_node())]);
  };
  EXPECT_EQ(driven[part(0)], 0);
  EXPECT_EQ(driven[part(1)], 1);
}

TEST(Muscle, ReactionsAreItsScale) {
  expect_reactions_to_count("model = \"meshless\"\nframes = { grid = [5, 2, 2] }\n", "");
  expect_reactions_to_count("model = \"hexahedra\"\norder = 1\n", ", cells = [4, 1, 1]");
}

/// St Venant-Kirchhoff's law bears less than half of Young's modulus where nothing pulls back: what is left then is no
/// body, whatever the residual says.
TEST(Muscle, FlatMatterIsCounted) {
  const Simulation s = built(pulling_beam("{ direction = [1, 0, 0] }", "stress = 1", "kind = \"static\"\n"));
  const auto folded_at = [&](double J) {
    State state = s.initial;
    for (std::size_t i = 0; i < state.u.size(); ++i) {
      state.u[i] = {{(J - 1) * s.model.rest_position[i][0], 0, 0}};
      state.D[i] = {};
    }
    return folded_points(s.bodies[0], state);
  };
  const int points = static_cast<int>(s.bodies[0].body->points().size());
  EXPECT_EQ(folded_at(2e-6).flat, 0);
  EXPECT_EQ(folded_at(5e-7).flat, points);
  EXPECT_EQ(folded_at(5e-7).inverted, 0);
  EXPECT_EQ(folded_at(-0.1).inverted, points);
  EXPECT_EQ(folded_at(-0.1).flat, 0);
}

State solved(const Simulation& s) {
  ThreadPool pool(1);
  SolverSettings settings = settings_of(s.scene.solver);
  settings.tolerance = 1e-10;
  MechanicalSystem system(s.model, pool, settings);
  State state = s.initial;
  const FactorFunction factors = [&](double time) { return s.factors(time); };
  PathSettings path;
  path.load_steps = 5;
  const RunReport report = s.scene.solver.control == StaticControl::load
                               ? run_statics(system, state, factors, settings, {.load_steps = 5}, {})
                               : run_path(system, state, factors, settings, path, {});
  EXPECT_EQ(report.status, RunStatus::converged);
  return state;
}

/// Along a path the load factor is an unknown, and so is that of the muscle: fibres askew bend and twist the beam.
TEST(Muscle, APathEndsWhereStepsDo) {
  const std::string askew = "{ direction = [2, 1, 0.5] }", pull = "stress = \"6 kPa\"";
  const State steps = solved(built(pulling_beam(askew, pull, "kind = \"static\"\n")));
  const State path = solved(built(pulling_beam(askew, pull, "kind = \"static\"\ncontrol = \"arc-length\"\n")));
  double apart = 0, size = 0;
  for (std::size_t i = 0; i < steps.u.size(); ++i) {
    apart = std::max(apart, norm(steps.u[i] - path.u[i]));
    size = std::max(size, norm(steps.u[i]));
  }
  EXPECT_GT(size, 0.1);
  EXPECT_LT(apart, 1e-8 * size);
}

}  // namespace
}  // namespace fascia::app::muscle_test
