#include "tests/unit/app/scene_text.hpp"

#include "core/base/errors.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace fascia::app::scene_errors_test {
namespace {

using test::beam_with;
using test::errors_of;
using test::errors_of_beam;

constexpr const char* where_all = "body = \"beam\"\nwhere = \"all\"\n";

std::string errors_of_constraint(const std::string& more) {
  return errors_of_beam("[[constraints]]\n" + std::string(where_all) + more);
}
std::string errors_of_load(const std::string& more) {
  return errors_of_beam("[[loads]]\n" + std::string(where_all) + more);
}

TEST(SceneErrors, SyntaxIsReportedWithItsPlace) {
  EXPECT_EQ(errors_of("a = 1\nb = \n"),
            "a.toml:2:5: toml: Error while parsing key-value pair: expected value, saw '\\n'; must be TOML 1.0");
  EXPECT_EQ(
      errors_of("a = 1\na = 2\n"),
      "a.toml:2:5: toml: Error while parsing key-value pair: cannot redefine existing integer 'a'; must be TOML 1.0");
}

TEST(SceneErrors, OutOfRange) {
  EXPECT_EQ(errors_of(beam_with("poisson = 0.3", "poisson = 0.6")),
            "a.toml:3:11: materials.soft.poisson: 0.6 is out of range; must be above -1 and below 0.5");
  EXPECT_EQ(errors_of(beam_with("\"40 kPa\"", "\"-40 kPa\"")),
            "a.toml:2:9: materials.soft.young: \"-40 kPa\" is out of range; must be above 0");
  EXPECT_EQ(errors_of(beam_with("[5, 2, 2]", "[5, 1, 2]")),
            "a.toml:9:23: bodies.beam.frames.grid[1]: 1 is out of range; must be from 2 to 1000");
  EXPECT_EQ(errors_of_beam("points = { per_cell = [2, 2, 0] }\n"),
            "a.toml:10:30: bodies.beam.points.per_cell[2]: 0 is out of range; must be from 1 to 10");
}

TEST(SceneErrors, NotFinite) {
  EXPECT_EQ(errors_of(beam_with("0.3", "nan")),
            "a.toml:3:11: materials.soft.poisson: nan is not finite; must be a number above -1 and below 0.5");
  EXPECT_EQ(errors_of_beam("[world]\ngravity = [0, -inf, 0]\n"),
            "a.toml:11:15: world.gravity[1]: -inf is not finite; must be an acceleration in m/s2");
  EXPECT_EQ(errors_of(beam_with("\"5 kg\"", "\"1e308 Mg\"")),
            "a.toml:7:8: bodies.beam.mass: \"1e308 Mg\" is too large; must be a mass in kg, such as \"200 g\"");
  EXPECT_EQ(
      errors_of(
          beam_with("\"40 kPa\"", "1e308").replace(beam_with("\"40 kPa\"", "1e308").find("0.3"), 3, "0.4999999999")),
      "a.toml:2:9: materials.soft.young: 1e+308 Pa with Poisson's ratio 0.4999999999 gives no finite stiffness; must "
      "be less extreme");
}

TEST(SceneErrors, Units) {
  EXPECT_EQ(errors_of(beam_with("\"5 kg\"", "\"5 m\"")),
            "a.toml:7:8: bodies.beam.mass: \"5 m\" is a length; must be a mass in kg, such as \"200 g\"");
  EXPECT_EQ(errors_of(beam_with("\"5 kg\"", "\"5\"")),
            "a.toml:7:8: bodies.beam.mass: \"5\" has no unit; write 5 (SI) or, with a unit, \"200 g\"");
}

TEST(SceneErrors, UnknownKeys) {
  EXPECT_EQ(errors_of_beam("weigths = {}\n"),
            "a.toml:10:1: bodies.beam.weigths: is no known key; did you mean \"weights\"?");
  EXPECT_EQ(errors_of("titel = \"x\"\n" + std::string(test::beam)),
            "a.toml:1:1: titel: is no known key; did you mean \"title\"?");
  EXPECT_EQ(errors_of_beam("[bodies.beam.transform]\n\"odd\\nkey\" = 1\n"),
            "a.toml:11:1: bodies.beam.transform.\"odd\\nkey\": is no known key; known here: translate, rotate, scale");
}

TEST(SceneErrors, MissingKeysAreReportedAtTheTable) {
  EXPECT_EQ(errors_of(beam_with("material = \"soft\"\n", "")),
            "a.toml:4:1: bodies.beam.material: is missing; must be the name of a material, a table with young, "
            "lame or c10 or a list, each a table with use");
  EXPECT_EQ(errors_of(beam_with("mass = \"5 kg\"\n", "")),
            "a.toml:4:1: bodies.beam: mass or density is missing; give exactly one");
  EXPECT_EQ(errors_of(beam_with("poisson = 0.3\n", "")),
            "a.toml:1:1: materials.soft.poisson: is missing beside young; must be a number above -1 and below 0.5");
  EXPECT_EQ(errors_of(""), "a.toml:1:1: bodies: is missing; must be tables with names");
  EXPECT_EQ(errors_of("bodies = {}"), "a.toml:1:10: bodies: is empty; needs at least one entry");
}

TEST(SceneErrors, WrongTypes) {
  EXPECT_EQ(errors_of(beam_with("\"5 kg\"", "true")),
            "a.toml:7:8: bodies.beam.mass: true is of the wrong type; must be a mass in kg above 0");
  EXPECT_EQ(errors_of(beam_with("[5, 2, 2]", "[5, 2.0, 2]")),
            "a.toml:9:23: bodies.beam.frames.grid[1]: 2.0 is of the wrong type; must be a whole number from 2 to 1000");
  EXPECT_EQ(errors_of(beam_with("\"meshless\"", "2020-01-01")),
            "a.toml:5:9: bodies.beam.model: a date is of the wrong type; must be \"meshless\", \"tetrahedra\", "
            "\"hexahedra\", \"shell\", \"rigid\" or \"surface\"");
  EXPECT_EQ(
      errors_of_beam("[world]\ngravity = 9.81\n"),
      "a.toml:11:11: world.gravity: 9.81 is of the wrong type; must be a list of 3, each an acceleration in m/s2");
  EXPECT_EQ(errors_of_beam("[[probes]]\nbody = \"beam\"\nat = [1, 2, 3]\n"),
            "a.toml:10:1: probes: a list of 1 is of the wrong type; must be tables with names");
  EXPECT_EQ(errors_of_beam("[world]\ngravity = [0, 1]\n"),
            "a.toml:11:11: world.gravity: a list of 2 is of the wrong length; must be a list of 3, each an "
            "acceleration in m/s2");
}

TEST(SceneErrors, Precision) {
  EXPECT_EQ(errors_of_beam("[solver]\nprecision = \"single\"\nbackend = \"cpu\"\n"),
            "a.toml:11:13: solver.precision: \"single\" needs the GPU; must be \"double\" or \"mixed\", or backend "
            "\"auto\" or \"cuda\"");
  EXPECT_EQ(errors_of_beam("[solver]\nprecision = \"mixed\"\nbackend = \"cpu\"\n"), "");
  EXPECT_EQ(errors_of_beam("[solver]\nkind = \"explicit\"\ntime_step = 1e-4\nsteps = 1\nprecision = \"mixed\"\n"),
            "a.toml:14:13: solver.precision: \"mixed\" is not used by kind = \"explicit\"; must be \"double\"");
  EXPECT_EQ(errors_of_beam("[solver]\nkind = \"modes\"\nprecision = \"mixed\"\n"),
            "a.toml:12:13: solver.precision: \"mixed\" is not used by kind = \"modes\"; must be \"double\"");
  EXPECT_EQ(errors_of_beam("[solver]\nprecision = \"half\"\n"),
            "a.toml:11:13: solver.precision: \"half\" is no known value; must be \"double\", \"mixed\" or \"single\"");
}

TEST(SceneErrors, SeveralGpus) {
  EXPECT_EQ(
      errors_of_beam("[solver]\ngpus = 2\nbackend = \"cpu\"\n"),
      "a.toml:11:8: solver.gpus: 2 does not go with backend = \"cpu\"; must be 1, or backend \"auto\" or \"cuda\"");
  EXPECT_EQ(errors_of_beam("[solver]\nkind = \"explicit\"\ntime_step = 1e-4\nsteps = 1\ngpus = 2\n"),
            "a.toml:14:8: solver.gpus: 2 is not used by kind = \"explicit\"; must be 1");
  EXPECT_EQ(
      errors_of_beam("[solver]\nprecision = \"single\"\ngpus = 4\n"),
      "a.toml:12:8: solver.gpus: 4 does not go with precision = \"single\"; must be 1, or precision \"double\" or "
      "\"mixed\"");
  EXPECT_EQ(errors_of_beam("[solver]\ngpus = 9\n"), "a.toml:11:8: solver.gpus: 9 is out of range; must be from 1 to 8");
}

TEST(SceneErrors, ValuesThatExcludeOneAnother) {
  EXPECT_EQ(errors_of_beam("density = 1\n"),
            "a.toml:10:11: bodies.beam.density: cannot stand beside mass; give only one of them");
  EXPECT_EQ(errors_of_beam("points = { per_cell = [1, 1, 1] }\nweights = { kind = \"linear\" }\n"),
            "a.toml:10:23: bodies.beam.points.per_cell: is not used by weights of kind \"linear\", which have 4 points "
            "in each tetrahedron; remove it");
}

TEST(SceneErrors, Materials) {
  EXPECT_EQ(errors_of(beam_with("\"soft\"", "\"sofd\"")),
            "a.toml:8:12: bodies.beam.material: \"sofd\" is no known material; did you mean \"soft\"?");
  EXPECT_EQ(
      errors_of(beam_with("\"soft\"", "{ lame = { lambda = -10, mu = 3 } }")),
      "a.toml:8:32: bodies.beam.material.lame.lambda: -10 Pa gives no stable material; must be above -2/3 mu, -2 Pa");
  EXPECT_EQ(
      errors_of(beam_with("\"soft\"", "[{ use = \"soft\" }, { where = \"all\", use = \"soft\" }]")),
      "a.toml:8:13: bodies.beam.material[0]: has no where, so that no later entry can match; must be the last one");
}

TEST(SceneErrors, Domains) {
  EXPECT_EQ(errors_of(beam_with("max = [4, 1, 1]", "max = [4, 0, 1]")),
            "a.toml:6:43: bodies.beam.domain.box.max: 0 along y is not above min, 0; must be above it");
  EXPECT_EQ(errors_of(beam_with("box = { min = [0, 0, 0], max = [4, 1, 1] }",
                                "cylinder = { from = [1, 0, 0], to = [1, 0, 0], radius = 1 }")),
            "a.toml:6:48: bodies.beam.domain.cylinder.to: is the same point as from; must be another point");
  EXPECT_EQ(errors_of(beam_with("[5, 2, 2]", "[1000, 1000, 1000]")),
            "a.toml:9:19: bodies.beam.frames.grid: asks for 1000000000 frames; must be at most 10000000");
}

TEST(SceneErrors, Names) {
  EXPECT_EQ(errors_of(beam_with("[bodies.beam]", "[bodies.\"a,b\"]")),
            "a.toml:4:9: bodies.\"a,b\": \"a,b\" cannot name a file; use up to 100 letters, digits, _ and -");
  EXPECT_EQ(errors_of_beam("[[constraints]]\nbody = \"bean\"\nwhere = \"all\"\nfix = \"all\"\n"),
            "a.toml:11:8: constraints[0].body: \"bean\" is no known body; did you mean \"beam\"?");
  EXPECT_EQ(errors_of_beam("[[loads]]\nbody = \"x\"\nat = [0, 0, 0]\nforce = [0, 0, 0]\n"),
            "a.toml:11:8: loads[0].body: \"x\" is no known body; must be \"beam\"");
}

TEST(SceneErrors, Constraints) {
  EXPECT_EQ(errors_of_constraint(""), "a.toml:10:1: constraints[0]: fix or move is missing; give exactly one");
  EXPECT_EQ(errors_of_constraint("fix = \"all\"\nmove = { translate = [1, 0, 0] }\n"),
            "a.toml:14:8: constraints[0].move: cannot stand beside fix; give only one of them");
  EXPECT_EQ(errors_of_constraint("fix = \"symmetry\"\n"),
            "a.toml:10:1: constraints[0].normal: is missing beside fix = \"symmetry\"; must be a vector");
  EXPECT_EQ(errors_of_constraint("fix = \"hinge\"\naxis = [0, 0, 0]\n"),
            "a.toml:14:8: constraints[0].axis: has no direction; must be a vector of a length other than 0");
  EXPECT_EQ(errors_of_constraint("fix = \"all\"\nover = 1\n"),
            "a.toml:14:8: constraints[0].over: is used only with move; remove it");
  EXPECT_EQ(errors_of_constraint("fix = \"all\"\naxes = [[1, 0, 0], [1, 1, 0], [0, 0, 1]]\n"),
            "a.toml:14:8: constraints[0].axes: axes 0 and 1 are not perpendicular (cosine 0.707); must be three "
            "perpendicular vectors");
  EXPECT_EQ(errors_of_constraint("move = { axes = [\"x\"] }\n"),
            "a.toml:13:8: constraints[0].move: moves nothing; must have translate, rotate or both");
  EXPECT_EQ(errors_of_constraint("fix = [\"x\", \"q\"]\n"),
            "a.toml:13:13: constraints[0].fix[1]: \"q\" is no known value; must be \"x\", \"y\", \"z\", \"rx\", \"ry\" "
            "or \"rz\"");
}

TEST(SceneErrors, Loads) {
  EXPECT_EQ(errors_of_load(""),
            "a.toml:10:1: loads[0]: applies nothing; must have total_force, total_torque, force_per_node, "
            "traction, pressure or line_force");
  EXPECT_EQ(errors_of_load("force = [1, 0, 0]\n"),
            "a.toml:13:9: loads[0].force: goes with at, not with where (there: total_force, total_torque, "
            "force_per_node, traction, pressure, line_force); remove it");
  EXPECT_EQ(errors_of_beam("[[loads]]\nbody = \"beam\"\nforce = [1, 0, 0]\n"),
            "a.toml:10:1: loads[0]: where or at is missing; give exactly one");
  EXPECT_EQ(errors_of_beam("[[loads]]\nbody = \"beam\"\nat = [0, 0, 0]\ntraction = [1, 0, 0]\n"),
            "a.toml:13:12: loads[0].traction: goes with where, not with at; remove it");
  EXPECT_EQ(errors_of_beam("[[loads]]\nbody = \"beam\"\ntraction = [1, 0, 0]\n"),
            "a.toml:10:1: loads[0]: where or at is missing; give exactly one");
  EXPECT_EQ(errors_of_load("traction = 1\n"),
            "a.toml:13:12: loads[0].traction: 1 is of the wrong type; must be a list of 3, each a pressure in Pa");
  EXPECT_EQ(errors_of_load("traction = [0, 0, \"1 N\"]\n"),
            "a.toml:13:19: loads[0].traction[2]: \"1 N\" is a force; must be a pressure in Pa, such as \"40 kPa\"");
  EXPECT_EQ(errors_of_load("traction = [1, 0, 0]\nfollower = true\n"),
            "a.toml:14:12: loads[0].follower: true does not go with traction, which keeps its direction; must be "
            "false");
  EXPECT_EQ(errors_of_load("total_force = [1, 0, 0]\nprofile = [[0, 0], [\"1 s\", 1], [1, 2]]\n"),
            "a.toml:14:32: loads[0].profile[2]: time 1 s is not after 1 s; times must ascend");
}

TEST(SceneErrors, Regions) {
  const auto errors = [](const std::string& region) {
    return errors_of_beam("[[constraints]]\nbody = \"beam\"\nfix = \"all\"\nwhere = " + region + "\n");
  };
  EXPECT_EQ(errors("{ box = { min = [0, 0, 1], max = [1, 1, 0] } }"),
            "a.toml:13:42: constraints[0].where.box.max: 0 along z is below min, 1; must be at least min");
  EXPECT_EQ(errors("{ halfspace = { point = [0, 0, 0], normal = [0, 0, 0] } }"),
            "a.toml:13:53: constraints[0].where.halfspace.normal: has no direction; must be a vector of a length other "
            "than 0");
  EXPECT_EQ(
      errors("{ boundary = false }"),
      "a.toml:13:22: constraints[0].where.boundary: false selects nothing; must be true, or not = { boundary = true }");
  EXPECT_EQ(errors("{ any_of = [{ spere = {} }] }"),
            "a.toml:13:21: constraints[0].where.any_of[0]: box, sphere, cylinder, halfspace, nearest, group, ids, "
            "boundary, all_of, any_of or not is missing; give exactly one\n"
            "a.toml:13:23: constraints[0].where.any_of[0].spere: is no known key; did you mean \"sphere\"?");
}

TEST(SceneErrors, FramesAreNeeded) {
  EXPECT_EQ(errors_of(beam_with("frames = { grid = [5, 2, 2] }\n", "")),
            "a.toml:4:1: bodies.beam.frames: is missing; must be a table with grid, poisson_disk, count, positions or "
            "file; or state what the results must be worth in [need], which then chooses it");
}

TEST(SceneErrors, Solver) {
  EXPECT_EQ(errors_of_beam("[solver]\ntime_step = 1\n"),
            "a.toml:11:13: solver.time_step: is not used by kind = \"static\"; remove it");
  EXPECT_EQ(errors_of_beam("[solver]\nkind = \"implicit-euler\"\nsteps = 3\n"),
            "a.toml:10:1: solver.time_step: is missing; must be a time in s above 0; or state what the results must be "
            "worth in "
            "[need], which then chooses it");
  EXPECT_EQ(errors_of_beam("[solver]\nkind = \"implicit-euler\"\ntime_step = 1\n"),
            "a.toml:10:1: solver.duration: is missing; must be a time in s above 0, or give steps");
  EXPECT_EQ(errors_of_beam("[solver]\nkind = \"implicit-euler\"\ntime_step = 1\nsteps = 1\nduration = 1\n"),
            "a.toml:14:12: solver.duration: cannot stand beside steps; give only one of them");
  EXPECT_EQ(errors_of_beam("[solver]\nkind = \"implicit-euler\"\ntime_step = 1e-9\nduration = 1e9\n"),
            "a.toml:13:12: solver.duration: takes 1e+18 steps of 1e-09 s; must take at most 1e9");
  EXPECT_EQ(errors_of_beam("[solver]\ncount = 3\n"),
            "a.toml:11:9: solver.count: is not used by kind = \"static\"; remove it");
}

TEST(SceneErrors, ProbesAndOutput) {
  EXPECT_EQ(
      errors_of_beam("[probes.time_step]\nquantity = \"mass\"\n"),
      "a.toml:10:1: probes.time_step: \"time_step\" is the name of a column of probes.csv; give the probe another "
      "one");
  EXPECT_EQ(
      errors_of_beam("[probes.p]\nquantity = \"stress\"\nbody = \"beam\"\n"),
      "a.toml:10:1: probes.p.at: is missing for quantity \"stress\"; must be a point of the body, or a list of points");
  EXPECT_EQ(errors_of_beam("[probes.p]\nquantity = \"force\"\nbody = \"beam\"\n"),
            "a.toml:10:1: probes.p.where: is missing for quantity \"force\"; must be a region");
  EXPECT_EQ(errors_of_beam("[probes.p]\nquantity = \"volume\"\nat = [0, 0, 0]\n"),
            "a.toml:12:6: probes.p.at: is not used by quantity \"volume\"; remove it");
  EXPECT_EQ(errors_of_beam("[probes.p]\nquantity = \"frequency\"\n"),
            "a.toml:11:12: probes.p.quantity: \"frequency\" is known only of modes; needs solver.kind = \"modes\"");
  EXPECT_EQ(
      errors_of_beam("[output]\nfields = [\"stres\"]\n"),
      "a.toml:11:11: output.fields[0]: \"stres\" is no known value; must be \"displacement\", \"rotation\", "
      "\"strain\", \"stress\", \"von_mises\", \"energy_density\", \"director\", \"thickness\", \"membrane_force\", "
      "\"bending_moment\", \"stress_outer\" or \"stress_inner\" (did you mean \"stress\"?)");
}

TEST(SceneErrors, AllInOneGoSortedByLine) {
  const std::string errors = errors_of(R"(titel = "x"
[materials.soft]
young = "40 m"
poisson = 0.6
[bodies.beam]
model = "meshless"
domain = { box = { min = [0, 0, "1 s"], max = [4, 1, 1] } }
material = "sofd"
frames = { grid = [5, 1, 2] }
[[constraints]]
body = "bean"
where = "al"
fix = "symmetry"
[probes.tip]
body = "beam"
quantity = "force"
)");
  EXPECT_EQ(errors, R"(a.toml:1:1: titel: is no known key; did you mean "title"?
a.toml:3:9: materials.soft.young: "40 m" is a length; must be a pressure in Pa, such as "40 kPa"
a.toml:4:11: materials.soft.poisson: 0.6 is out of range; must be above -1 and below 0.5
a.toml:5:1: bodies.beam: mass or density is missing; give exactly one
a.toml:7:33: bodies.beam.domain.box.min[2]: "1 s" is a time; must be a length in m, such as "5 mm"
a.toml:8:12: bodies.beam.material: "sofd" is no known material; did you mean "soft"?
a.toml:9:23: bodies.beam.frames.grid[1]: 1 is out of range; must be from 2 to 1000
a.toml:10:1: constraints[0].normal: is missing beside fix = "symmetry"; must be a vector
a.toml:11:8: constraints[0].body: "bean" is no known body; did you mean "beam"?
a.toml:12:9: constraints[0].where: "al" is no known value; must be "all" or a table with box, sphere, cylinder, halfspace, nearest, group, ids, boundary, all_of, any_of or not
a.toml:14:1: probes.tip.where: is missing for quantity "force"; must be a region)");
}

TEST(SceneErrors, DiagnosticsHoldTheirPlace) {
  try {
    test::parse(beam_with("0.3", "0.6"));
    FAIL();
  } catch (const SceneError& error) {
    ASSERT_EQ(error.diagnostics().size(), 1u);
    EXPECT_EQ(error.diagnostics()[0].place.key, "materials.soft.poisson");
    EXPECT_EQ(error.diagnostics()[0].place.line, 3);
  }
}

TEST(SceneErrors, GarbageIsRefused) {
  EXPECT_EQ(errors_of(std::string(std::size_t{17} << 20, ' ')),
            "a.toml:1:1: toml: the file is larger than 16 MiB; must be a scene, which is small");
  EXPECT_NE(errors_of(std::string("\0\1\2\xff\xfe", 5)), "");
  std::string dotted = "a";
  for (int i = 0; i < 100000; ++i) dotted += ".a";
  EXPECT_EQ(errors_of(dotted + " = 1"), "a.toml:1:514: toml: nested more than 256 levels deep; must be TOML 1.0");
  std::string tables = "x";
  for (int i = 0; i < 10000; ++i) tables += " = {a.b.c.d.e.f.g";
  EXPECT_NE(errors_of(tables).find("nested more than 256 levels deep"), std::string::npos);
  EXPECT_NE(errors_of(std::string(100000, '[')), "");
  EXPECT_EQ(errors_of("[%]"),
            "a.toml:1:2: toml: Error while parsing key: expected bare key starting character or string "
            "delimiter, saw '%'; must be TOML 1.0");
}

TEST(SceneErrors, LettersBeyondAsciiBelongInQuotes) {
  EXPECT_EQ(errors_of("title = \"µ\" # é\n" + std::string(test::beam)), "");
  EXPECT_EQ(errors_of("title = \"\"\"a \\\n  µm\"\"\"\n" + std::string(test::beam)), "");
  EXPECT_EQ(errors_of("\xEF\xBB\xBF" + std::string(test::beam)), "");
  EXPECT_EQ(errors_of("a = é\n"), "a.toml:1:5: toml: a character beyond ASCII outside quotes; must be TOML 1.0");
}

TEST(SceneErrors, DotsInTextsAndNumbersDoNotNest) {
  EXPECT_EQ(errors_of("title = \"" + std::string(1000, '.') + "\" # " + std::string(1000, '.') + "\n" +
                      std::string(test::beam)),
            "");
  std::string numbers = "[[loads]]\nbody = \"beam\"\nwhere = { ids = [0";
  for (int i = 0; i < 1000; ++i) numbers += ", 1";
  EXPECT_EQ(errors_of_beam(numbers + "] }\ntotal_force = [0.5, 0.5, 0.5]\n"), "");
}

TEST(SceneErrors, RegionsNestToALimit) {
  const auto nested = [](int levels) {
    std::string region = "\"all\"";
    for (int i = 1; i < levels; ++i) region = "{ not = " + region + " }";
    return errors_of_beam("[[constraints]]\nbody = \"beam\"\nfix = \"all\"\nwhere = " + region + "\n");
  };
  EXPECT_EQ(nested(64), "");
  EXPECT_NE(nested(65).find(": the regions are nested too deeply; at most 64 levels"), std::string::npos);
}

TEST(SceneErrors, EndlessErrorsAreCounted) {
  std::string text(test::beam);
  for (int i = 0; i < 3000; ++i) text += "key" + std::to_string(i) + " = 1\n";
  EXPECT_NE(errors_of(text).find(": 2000 more errors; correct the first ones"), std::string::npos);
}

TEST(SceneErrors, FilesThatCannotBeRead) {
  EXPECT_THROW(parse_scene_file("no/such/scene.toml", {}), FileError);
  EXPECT_THROW(parse_scene_file(std::filesystem::temp_directory_path(), {}), FileError);
}

}  // namespace
}  // namespace fascia::app::scene_errors_test
