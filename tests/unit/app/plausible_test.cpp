#include "app/plausible/plausible.hpp"
#include "app/reader/parse.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/specification/readable.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>

// What the plausibility of a scene says, and that it says nothing of sound ones.
namespace fascia::app::plausible_test {
namespace {

/// A scene with places for one mistake each.
struct Words {
  std::string head, gravity = "[0, 0, -9.81]", young = "\"5 kPa\"", material, matter = "density = 1060",
                    domain = "box = { min = [0, 0, 0], max = [0.16, 0.1, 0.08] }",
                    body = "frames = { grid = [5, 4, 4] }",
                    region = "box = { min = [-1, -1, -0.01], max = [1, 1, 0.001] }",
                    solver = "kind = \"implicit-euler\"\ntime_step = 0.01\nduration = 1", rest;
};

Simulation build(const Words& w) {
  const std::string text = fmt::format(
      "{}\n[world]\ngravity = {}\n[materials.liver]\nyoung = {}\npoisson = 0.4\n{}\n"
      "[bodies.organ]\nmodel = \"meshless\"\nmaterial = \"liver\"\n{}\ndomain = {{ {} }}\n{}\n"
      "[[constraints]]\nbody = \"organ\"\nwhere = {{ {} }}\nfix = \"all\"\n[solver]\n{}\n{}\n",
      w.head, w.gravity, w.young, w.material, w.matter, w.domain, w.body, w.region, w.solver, w.rest);
  Simulation s = build_simulation(parse_scene_text(text, "organ.toml", {}));
  warn_of_the_implausible(s);
  return s;
}

/// The warnings of a scene, without those of its sampling.
std::vector<std::string> warnings_of(const Words& words) {
  std::vector<std::string> texts = build(words).warnings.summary();
  std::erase_if(texts, [](const std::string& t) { return t.ends_with("[sampling]"); });
  return texts;
}

/// Expects one warning of a name at a key.
void expect_one(const Words& words, const std::string& key, const std::string& name) {
  const std::vector<std::string> texts = warnings_of(words);
  ASSERT_EQ(texts.size(), 1u) << key << (texts.empty() ? "" : ": " + texts[0]);
  EXPECT_TRUE(texts[0].starts_with(key + ": ")) << texts[0];
  EXPECT_TRUE(texts[0].ends_with("[" + name + "]")) << texts[0];
}

TEST(Plausible, SaysNothingOfASoundScene) {
  EXPECT_EQ(warnings_of({}), std::vector<std::string>{});
  EXPECT_EQ(warnings_of({.solver = "kind = \"static\""}), std::vector<std::string>{});
}

TEST(Plausible, Bodies) {
  expect_one({.young = "5", .solver = "kind = \"static\""}, "materials.liver.young", "stiffness");
  expect_one({.young = "\"5 mPa\"", .solver = "kind = \"static\""}, "materials.liver.young", "stiffness");
  expect_one({.young = "2.1e5", .matter = "density = 7850"}, "materials.liver.young", "stiffness");
  expect_one({.young = "\"210 GPa\"", .solver = "kind = \"static\""}, "materials.liver.young", "stiffness");
  expect_one({.matter = "density = 1.06"}, "bodies.organ.density", "density");
  expect_one({.matter = "mass = 1300"}, "bodies.organ.mass", "density");
  expect_one({.young = "\"5 MPa\"",
              .domain = "box = { min = [0, 0, 0], max = [160, 100, 80] }",
              .region = "box = { min = [-1, -1, -1], max = [999, 999, 0.1] }",
              .solver = "kind = \"static\""},
             "bodies.organ.domain", "size");
  expect_one({.young = "200", .solver = "kind = \"static\""}, "materials.liver.young", "sag");
}

/// Without weight and inertia a density is only a number that must be there.
TEST(Plausible, DensityCountsWhereItDoesSomething) {
  EXPECT_EQ(warnings_of({.gravity = "[0, 0, 0]", .matter = "density = 1", .solver = "kind = \"static\""}),
            std::vector<std::string>{});
}

TEST(Plausible, LoadsAndMotions) {
  const std::string load =
      "[[loads]]\nbody = \"organ\"\nwhere = { halfspace = { point = [0, 0, 0.079], normal = [0, 0, 1] } }\n";
  expect_one({.rest = load + "total_force = [1e6, 0, 0]"}, "loads[0].total_force", "load");
  expect_one({.rest = load + "pressure = 1e9"}, "loads[0].pressure", "load");
  EXPECT_EQ(warnings_of({.rest = load + "total_force = [1, 0, 0]"}), std::vector<std::string>{});
  expect_one({.body = "frames = { grid = [5, 4, 4] }\ninitial = { velocity = [500, 0, 0] }"},
             "bodies.organ.initial.velocity", "velocity");
  expect_one({.rest = "[couplings.band]\nkind = \"spring\"\nbody = \"organ\"\nwhere = \"all\"\npoint = [0, 0, 1]\n"
                      "stiffness = 1e12"},
             "couplings.band.stiffness", "spring");
}

/// What a thin wall, a turn and the earth can have.
TEST(Plausible, WallsTurnsAndGravity) {
  const auto wall = [](const std::string& thickness, const std::string& pressure) {
    return "[bodies.wall]\nmodel = \"shell\"\nmaterial = \"liver\"\ndensity = 1060\nthickness = " + thickness +
           "\ndomain = { sphere = { center = [0, 0, 1], radius = 0.03, cells = [12] } }\n"
           "[[constraints]]\nbody = \"wall\"\nwhere = { halfspace = { point = [0, 0, 0.98], normal = [0, 0, 1] } }\n"
           "fix = \"all\"\n[[loads]]\nbody = \"wall\"\nwhere = \"all\"\npressure = " +
           pressure;
  };
  const Words still{.gravity = "[0, 0, 0]", .solver = "kind = \"static\""};
  const auto with_rest = [&](const std::string& rest) {
    Words words = still;
    words.rest = rest;
    return words;
  };
  EXPECT_EQ(warnings_of(with_rest(wall("\"3 mm\"", "\"100 Pa\""))), std::vector<std::string>{});
  expect_one(with_rest(wall("\"3 mm\"", "\"1 kPa\"")), "loads[0].pressure", "load");
  expect_one(with_rest(wall("\"3 um\"", "\"0.1 Pa\"")), "bodies.wall.thickness", "size");
  const auto turn = [](const std::string& angle) {
    return "[[constraints]]\nbody = \"organ\"\nwhere = { box = { min = [-1, -1, 0.079], max = [1, 1, 1] } }\n"
           "move = { rotate = { axis = [0, 0, 1], center = [0, 0, 0], angle = " +
           angle + " } }";
  };
  expect_one(with_rest(turn("30")), "constraints[1].move.rotate.angle", "load");
  EXPECT_EQ(warnings_of(with_rest(turn("\"720 degree\""))), std::vector<std::string>{});
  expect_one({.gravity = "[0, 0, -9810]", .young = "\"5 GPa\"", .solver = "kind = \"static\""}, "world.gravity",
             "load");
}

/// A material that creeps to its end within the run may be meant; one that hardly moves is not.
TEST(Plausible, CreepThatEndsInTime) {
  Words words{.material = "damping = { stiffness = \"20 s\" }",
              .solver = "kind = \"implicit-euler\"\ntime_step = \"5 s\"\nduration = \"10 min\""};
  EXPECT_EQ(warnings_of(words), std::vector<std::string>{});
  words.solver = "kind = \"implicit-euler\"\ntime_step = 0.01\nduration = 1";
  expect_one(words, "materials.liver.damping.stiffness", "damping");
}

TEST(Plausible, Times) {
  const std::string load = "[[loads]]\nbody = \"organ\"\nat = [0.16, 0.1, 0.08]\nforce = [0.1, 0, 0]\n";
  expect_one({.rest = load + "over = \"1 ms\""}, "solver.time_step", "time-step");
  expect_one({.rest = load + "profile = { sine = { period = \"20 ms\" } }"}, "solver.time_step", "time-step");
  expect_one({.solver = "kind = \"implicit-euler\"\ntime_step = 1e-9\nduration = 1"}, "solver.time_step", "duration");
  expect_one({.solver = "kind = \"newmark\"\ntime_step = 1e-4\nduration = 1e-3"}, "solver.duration", "duration");
  expect_one({.material = "damping = { mass = 1e6 }"}, "materials.liver.damping.mass", "damping");
  expect_one({.material = "damping = { stiffness = 20 }"}, "materials.liver.damping.stiffness", "damping");
}

/// Steps that see a stress fade may be meant, however slow they are beside vibrations.
TEST(Plausible, RelaxationThatStepsSee) {
  const std::string fades = "viscosity = [{ share = 0.5, time = \"20 s\" }]";
  Words words{.material = fades, .solver = "kind = \"implicit-euler\"\ntime_step = \"5 s\"\nduration = \"10 min\""};
  EXPECT_EQ(warnings_of(words), std::vector<std::string>{});
  words.material = "viscosity = [{ share = 0.5, time = \"20 ms\" }]";
  expect_one(words, "solver.time_step", "time-step");
  expect_one({.gravity = "[0, 0, 0]", .material = fades, .solver = "kind = \"modes\"\ncount = 3"},
             "materials.liver.viscosity", "no-effect");
  expect_one({.material = fades + "\nstatics = \"long-term\""}, "materials.liver.statics", "no-effect");
  // A static scene is judged by what lasts.
  expect_one(
      {.young = "2.2e5", .material = "viscosity = [{ share = 0.9999, time = 1 }]", .solver = "kind = \"static\""},
      "materials.liver.young", "sag");
}

TEST(Plausible, MusclePulls) {
  const auto muscle = [](const std::string& stress, const std::string& more) {
    return "fibres = [{ direction = [1, 0, 0] }]\nactive = { stress = " + stress + more + " }";
  };
  Words words{.young = "1e4", .material = muscle("4.9e3", ""), .solver = "kind = \"static\""};
  EXPECT_EQ(warnings_of(words), std::vector<std::string>{});
  words.material = muscle("5e3", "");
  expect_one(words, "materials.liver.active", "load");
  words.material = muscle("2.5e3", ", profile = [[0, 0], [1, 1], [2, 0]]");
  expect_one(words, "materials.liver.active", "load");
  words.material = muscle("2.5e3", ", profile = [[0, 0], [1, -1]]");
  expect_one(words, "materials.liver.active", "load");
}

TEST(Plausible, KeysThatDoNothing) {
  const std::string load = "[[loads]]\nbody = \"organ\"\nat = [0.16, 0.1, 0.08]\nforce = [0.1, 0, 0]\nover = 1\n";
  expect_one({.solver = "kind = \"static\"", .rest = load}, "loads[0].over", "no-effect");
  expect_one({.rest = load + "profile = [[0, 0], [1, 1]]"}, "loads[0].over", "no-effect");
  expect_one({.material = "damping = { mass = 1 }", .solver = "kind = \"static\""}, "materials.liver.damping",
             "no-effect");
  expect_one({.rest = "[materials.other]\nyoung = 1e4\npoisson = 0.3"}, "materials.other", "no-effect");
  expect_one(
      {.rest = "[[loads]]\nbody = \"organ\"\nwhere = { halfspace = { point = [0, 0, 0.001], normal = [0, 0, 1] } }\n"
               "total_force = [1, 0, 0]"},
      "loads[0].where", "no-effect");
  expect_one({.region = "box = { min = [-1, -1, -1], max = [1, 1, 1] }"}, "constraints[0].where", "held");
}

TEST(Plausible, BodiesThatIntersect) {
  const auto second = [](double from, const std::string& more = "") {
    return fmt::format(
        "[bodies.other]\nmodel = \"hexahedra\"\nmaterial = \"liver\"\ndensity = 1060\n"
        "domain = {{ box = {{ min = [{}, 0, 0], max = [0.3, 0.1, 0.08], cells = [6, 4, 4] }} }}\n{}",
        from, more);
  };
  expect_one({.rest = second(0.15)}, "bodies.other.domain", "overlap");
  EXPECT_NE(warnings_of({.rest = second(0.15)})[0].find("by 10 mm"), std::string::npos);
  EXPECT_EQ(warnings_of({.rest = second(0.16)}), std::vector<std::string>{}) << "they touch";
  EXPECT_EQ(warnings_of({.rest = second(0.15,
                                        "[couplings.glue]\nkind = \"embed\"\nbody = \"other\"\n"
                                        "where = { box = { min = [0, 0, 0], max = [0.16, 1, 1] } }\nto = \"organ\"")}),
            std::vector<std::string>{})
      << "they are coupled";
}

TEST(Plausible, IsSilencedByName) {
  const Simulation s = build({.head = "silence = [\"stiffness\"]", .young = "5"});
  EXPECT_EQ(s.warnings.silenced(), 1u);
  for (const std::string& text : s.warnings.summary()) EXPECT_FALSE(text.ends_with("[stiffness]")) << text;
}

TEST(Readable, TakesTheUnitThatPeopleUse) {
  EXPECT_EQ(length_text(0.16), "16 cm");
  EXPECT_EQ(length_text(20e-6), "20 um");
  EXPECT_EQ(box_text({{0.16, 0.1, 0.008}}), "16 x 10 x 0.8 cm");
  EXPECT_EQ(mass_text(38000), "38 t");
  EXPECT_EQ(volume_text(1.5e-3), "1.5 l");
  EXPECT_EQ(pressure_text(5e-3), "5 mPa");
  EXPECT_EQ(pressure_text(2.1e11), "210 GPa");
  EXPECT_EQ(time_text(0.04), "40 ms");
}

}  // namespace
}  // namespace fascia::app::plausible_test
