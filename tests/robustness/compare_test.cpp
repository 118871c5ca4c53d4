// `fascia compare` of results of different meshes and models: the difference is known in closed form.
#include "tests/robustness/scene_runs.hpp"

#include <cmath>

namespace fascia::test::compare_test {
namespace {

using Json = nlohmann::json;

/// A block of 2 × 1 × 1 m without lateral contraction, held by symmetry planes, its end pulled by 0.5 m: u = X/4 along
/// x.
constexpr const char* kStretch = R"([bodies.block]
BODY
density = 1000
material = { young = "10 kPa", poisson = 0 }

[[constraints]]
body = "block"
where = { box = { min = [-0.01, -9, -9], max = [0.01, 9, 9] } }
fix = ["x"]

[[constraints]]
body = "block"
where = "all"
fix = GUIDE

[[constraints]]
body = "block"
where = { box = { min = [1.99, -9, -9], max = [2.01, 9, 9] } }
move = { translate = [0.5, 0, 0], axes = ["x"] }

[solver]
kind = "static"
newton = { tolerance = 1e-12 }

[probes.end]
body = "block"
at = [2, 0.5, PLANE]
quantity = "displacement"
)";

constexpr const char* kFrames = R"(model = "meshless"
domain = { box = { min = [0, 0, 0], max = [2, 1, 1] } }
frames = { grid = [5, 3, 3] })";
constexpr const char* kTetrahedra = R"(model = "tetrahedra"
domain = { box = { min = [0, 0, 0], max = [2, 1, 1], cells = [3, 2, 2] } })";
constexpr const char* kHexahedra = R"(model = "hexahedra"
order = 2
domain = { box = { min = [0, 0, 0], max = [2, 1, 1], cells = [5, 2, 1] } })";
constexpr const char* kShell = R"(model = "shell"
thickness = "1 cm"
domain = { rectangle = { origin = [0, 0, 0], edge_u = [2, 0, 0], edge_v = [0, 1, 0], cells = [5, 2] } })";
constexpr const char* kSheet = R"(model = "meshless"
thickness = "1 cm"
domain = { rectangle = { origin = [0, 0, 0], edge_u = [2, 0, 0], edge_v = [0, 1, 0] } }
frames = { grid = [7, 4] })";

class Compare : public SceneRuns {
 protected:
  void run(const std::string& output, const std::string& scene, const std::vector<std::string>& settings = {}) const {
    write(output + ".toml", scene);
    std::vector<std::string> command{"run", output + ".toml", "--output", output, "--quiet"};
    for (const std::string& setting : settings) command.insert(command.end(), {"--set", setting});
    const ProgramResult result = fascia(command);
    ASSERT_EQ(result.status, 0) << result.err;
  }

  /// A stretched block by another length. @param end  of its displacement at x = 2 [m]
  void stretch(const std::string& output, const std::string& body, double end, const std::string& plane = "0.5") const {
    const bool nodes = body.find("hedra") != std::string::npos;  // have no rotations
    const std::string guide = nodes ? R"(["y", "z"])" : R"(["y", "z", "rx", "ry", "rz"])";
    run(output, with(with(with(kStretch, "BODY", body), "PLANE", plane), "GUIDE", guide),
        {"constraints[2].move.translate=[" + std::to_string(end) + ",0,0]"});
  }

  Json compared(const std::string& a, const std::string& b) const {
    const ProgramResult result = fascia({"compare", a, b, "--json"});
    EXPECT_LE(result.status, 1) << result.err;
    return Json::parse(result.out);
  }

  void expect(const std::vector<std::string>& command, int status, const std::string& says) const {
    const ProgramResult result = fascia(command);
    EXPECT_EQ(result.status, status) << result.out << result.err;
    EXPECT_NE((result.out + result.err).find(says), std::string::npos) << result.out << result.err;
  }
};

/// The two differ by 0.05 X: 0.05 √(4/3) m as root mean square over the body, a fifth of the larger, 0.1 m at most at
/// the end. The fields are linear, which every mesh represents: what is left is the solver's tolerance and the files'
/// digits.
void expect_stretch(const Json& j) {
  EXPECT_EQ(j.at("method"), "interpolated");
  EXPECT_EQ(j.at("structure"), Json::array());
  const Json& field = j.at("fields").at("block: displacement");
  EXPECT_NEAR(field.at("relative").get<double>(), 0.2, 1e-6);
  EXPECT_NEAR(field.at("root_mean_square").get<double>(), 0.05 * std::sqrt(4.0 / 3), 1e-7);
  EXPECT_NEAR(field.at("largest").at("difference").get<double>(), 0.1, 1e-7);
  EXPECT_NEAR(field.at("largest").at("rest_position")[0].get<double>(), 2, 1e-9);
  EXPECT_NEAR(j.at("probes").at("end").at("relative").get<double>(), 0.2, 1e-6);
}

TEST_F(Compare, SolidsOfDifferentMeshesDifferByTheKnownField) {
  stretch("frames", kFrames, 0.5);
  stretch("tetrahedra", kTetrahedra, 0.4);
  stretch("hexahedra", kHexahedra, 0.5);
  stretch("finer", with(kFrames, "[5, 3, 3]", "[6, 4, 3]"), 0.4);
  for (const auto& [a, b] : {std::pair{"frames", "tetrahedra"}, std::pair{"tetrahedra", "hexahedra"},
                             std::pair{"frames", "finer"}, std::pair{"tetrahedra", "frames"}}) {
    SCOPED_TRACE(std::string(a) + " " + b);
    const Json j = compared(a, b);
    expect_stretch(j);
    // Green-Lagrange strain 0.25 + 0.25²/2 against 0.2 + 0.2²/2.
    EXPECT_NEAR(j.at("fields").at("block: strain").at("relative").get<double>(), 1 - 0.22 / 0.28125, 1e-5);
  }
  expect({"compare", "frames", "hexahedra", "--tolerance", "1e-5"}, 0, "within the tolerance");
  expect({"compare", "frames", "tetrahedra", "--tolerance", "0.4"}, 0, "meshes or times differ");
  expect({"compare", "frames", "tetrahedra", "--tolerance", "0.21"}, 1, "block: ");  // the stress differs by more
  expect({"compare", "frames", "tetrahedra", "--tolerance", "0.21", "--only", "displacement,end"}, 0, "within");
  expect({"compare", "frames", "tetrahedra", "--only", "speed"}, 2, "--only speed: is no field or probe");
  expect({"compare", "frames", "tetrahedra"}, 1, "bodies.block.model: \"meshless\" in A, \"tetrahedra\" in B");
}

/// Stretch at X of a column of 40 kPa that hangs from X = 0 and is 2 m long, its sides guided:
/// (λ + 2 μ) l (l² − 1)/2 = ρ g (2 − X).
double column_stretch(double gravity, double X) {
  const double modulus = 40e3 * (1 - 0.3) / (1.3 * (1 - 0.6)), pull = 1000 * gravity * (2 - X);
  double l = 1;
  for (int i = 0; i < 50; ++i) l -= (modulus * l * (l * l - 1) / 2 - pull) / (modulus * (3 * l * l - 1) / 2);
  return l;
}

/// The displacement is no polynomial; both solutions have errors of their own, that of 17 frames is 0.4 % of the
/// difference.
TEST_F(Compare, ColumnsUnderOtherWeightsDifferAsTheClosedFormSays) {
  std::string column = read_text(source_dir() / "scenes/hanging_column.toml");
  run("frames", column, {"bodies.column.frames.grid=[17,2,2]"});
  column =
      with(with(column, "model = \"meshless\"", "model = \"hexahedra\"\norder = 2"), ", \"rx\", \"ry\", \"rz\"", "");
  column = with(with(column, "frames = { grid = [9, 2, 2] }", ""), "max = [2, 0.2, 0.2]",
                "max = [2, 0.2, 0.2], cells = [8, 1, 1]");
  run("cells", column, {"world.gravity=[8,0,0]"});
  constexpr int n = 2000;
  constexpr double h = 2.0 / n;
  double a = 0, b = 0, squares = 0, squares_a = 0;  // midpoint rule
  for (int i = 0; i < n; ++i) {
    const double X = (i + 0.5) * h, slope_a = column_stretch(9.81, X) - 1, slope_b = column_stretch(8, X) - 1;
    const double here_a = a + slope_a * h / 2, apart = here_a - b - slope_b * h / 2;
    squares_a += here_a * here_a * h;
    squares += apart * apart * h;
    a += slope_a * h;
    b += slope_b * h;
  }
  const Json field = compared("frames", "cells").at("fields").at("column: displacement");
  const double root_mean = std::sqrt(squares / 2), relative = std::sqrt(squares / squares_a);
  EXPECT_NEAR(field.at("root_mean_square").get<double>(), root_mean, 0.005 * root_mean);
  EXPECT_NEAR(field.at("relative").get<double>(), relative, 0.005 * relative);
  EXPECT_NEAR(field.at("largest").at("difference").get<double>(), a - b, 0.005 * (a - b));
}

/// Results of one mesh are compared array by array, with norms and places beside.
TEST_F(Compare, OfOneMeshHasPlacesToo) {
  stretch("a", kTetrahedra, 0.5);
  stretch("b", kTetrahedra, 0.4);
  const Json j = compared("a", "b");
  EXPECT_EQ(j.at("method"), "array by array");
  const Json& field = j.at("fields").at("block: displacement");
  EXPECT_NEAR(field.at("relative").get<double>(), 0.2, 1e-9);
  EXPECT_EQ(field.at("largest").at("rest_position")[0], 2);
  EXPECT_TRUE(j.at("quantities").contains("block: points"));
}

TEST_F(Compare, ShellsAndSheetsDifferByTheKnownField) {
  stretch("shell", kShell, 0.5, "0");
  stretch("sheet", kSheet, 0.4, "0");
  stretch("finer", with(kShell, "[5, 2]", "[4, 3]"), 0.4, "0");
  expect_stretch(compared("shell", "sheet"));
  expect_stretch(compared("shell", "finer"));
}

/// A thin wall within the solid that it models: compared on its middle surface.
TEST_F(Compare, AShellAndASolidAreComparedOnTheShell) {
  stretch("shell", with(kShell, "[0, 0, 0]", "[0, 0, 0.5]"), 0.5);
  stretch("solid", kHexahedra, 0.4);
  const Json j = compared("solid", "shell");
  expect_stretch(j);
  EXPECT_EQ(j.at("bodies").at("block").at("measure"), "area");
}

/// u = g t²/2 of free fall, saved at other times: linear between states 20 ms apart, wrong by g (20 ms)²/8 at most.
TEST_F(Compare, TimesBetweenTwoStatesAreInterpolated) {
  const std::string fall = R"([bodies.block]
BODY
density = 1000
material = { young = "10 kPa", poisson = 0 }
[world]
gravity = [0, 0, -10]
[solver]
kind = "midpoint"
time_step = "10 ms"
duration = "300 ms"
[output]
every_steps = 2
)";
  run("frames", with(fall, "BODY", kFrames));
  run("cells", with(fall, "BODY", kTetrahedra),
      {"solver.time_step=0.03", "output.every_steps=1", "world.gravity=[0,0,-8]"});
  const Json j = compared("frames", "cells");
  EXPECT_EQ(j.at("structure"), Json::array());
  const Json& field = j.at("fields").at("block: displacement");
  EXPECT_NEAR(field.at("relative").get<double>(), 0.2, 0.2 * 0.01);  // at the end both have the time
  EXPECT_NEAR(field.at("largest").at("difference").get<double>(), 0.09, 1e-6);
  EXPECT_NE(j.at("notes").dump().find("interpolated linearly"), std::string::npos) << j.at("notes");
}

/// Rows of probes.csv are those of one load factor each, however many a run has.
TEST_F(Compare, LoadStepsAreNotMistakenForOneAnother) {
  run("one", kCantilever, {"solver.load_steps=1"});
  run("five", kCantilever, {"solver.load_steps=5"});
  const Json j = compared("one", "five");
  EXPECT_LT(j.at("quantities").at("tip").at("relative").get<double>(), 1e-6);
}

/// A mode's size and sign mean nothing: two meshes of one beam have nearly the same.
TEST_F(Compare, ModesAreScaledToOneAnother) {
  const std::string modes =
      with(with(kCantilever, "\"static\"", "\"modes\"\ncount = 1"), "[1, 0.2, 0.2]", "[1, 0.2, 0.1]");
  run("a", modes, {"bodies.beam.frames.grid=[9,3,3]", "probes.tip="});
  run("b", modes, {"bodies.beam.frames.grid=[11,4,3]", "probes.tip="});
  const Json j = compared("a", "b");
  EXPECT_LT(j.at("fields").at("beam: displacement").at("relative").get<double>(), 0.01);
  EXPECT_EQ(j.at("fields").size(), 1u);
}

/// A probe that only one has is no reason to fail where others count alone.
TEST_F(Compare, ProbesThatOnlyOneHasAreTold) {
  stretch("a", kFrames, 0.5);
  write("b.toml", read_text(folder_ / "a.toml") + "[probes.more]\nbody = \"block\"\nquantity = \"mass\"\n");
  ASSERT_EQ(fascia({"run", "b.toml", "--output", "b", "--quiet"}).status, 0);
  expect({"compare", "a", "b"}, 1, "probes.csv has other columns: B alone has more");
  expect({"compare", "a", "b", "--only", "displacement"}, 0, "B alone has more");
  write("c.toml", read_text(folder_ / "b.toml") + "[probes.last]\nquantity = \"mass\"\n");
  ASSERT_EQ(fascia({"run", "c.toml", "--output", "c", "--quiet"}).status, 0);
  expect({"compare", "b", "c", "--only", "more"}, 0, "B alone has last");
  expect({"compare", "b", "c", "--only", "last"}, 2, "--only last: is no field or probe that both results have");
}

/// Which one comes first makes no difference.
TEST_F(Compare, IsSymmetric) {
  stretch("a", kFrames, 0.5);
  stretch("b", kTetrahedra, 0.4);
  const Json ab = compared("a", "b"), ba = compared("b", "a");
  EXPECT_DOUBLE_EQ(ab.at("largest").get<double>(), ba.at("largest").get<double>());
  EXPECT_EQ(ab.at("fields").at("block: strain").at("largest").at("rest_position"),
            ba.at("fields").at("block: strain").at("largest").at("rest_position"));
  EXPECT_EQ(ab.at("settings")[0].at("a"), ba.at("settings")[0].at("b"));
}

TEST_F(Compare, WhatCannotBeComparedIsTold) {
  stretch("a", kFrames, 0.5);
  stretch("b", kTetrahedra, 0.5);
  const std::string brick = R"([bodies.brick]
model = "tetrahedra"
domain = { box = { min = [0, 0, 0], max = [2, 1, 1], cells = [1, 1, 1] } }
density = 1000
material = { young = "10 kPa", poisson = 0 }
[[constraints]]
body = "brick"
where = "all"
fix = "all"
)";
  run("other", brick);
  expect({"compare", "a", "other", "--tolerance", "1"}, 1, "body \"block\" is in A alone");
  const std::string far = with(with(kTetrahedra, "[0, 0, 0]", "[0, 0, 7]"), "[2, 1, 1]", "[2, 1, 8]");
  stretch("far", far, 0.5, "7.5");
  expect({"compare", "a", "far", "--tolerance", "1"}, 1, "is it the same body?");
  Json running = summary("b");
  running["status"] = "running";
  write("b/summary.json", running.dump());
  expect({"compare", "a", "b", "--tolerance", "1"}, 1, "B still runs, or was killed");
  running["status"] = "converged";
  running["fascia"] = "0.0.1";
  write("b/summary.json", running.dump());
  expect({"compare", "a", "b", "--tolerance", "1e-4"}, 0, "version: ");
  const std::string vtu = read_text(folder_ / "b/block_00000.vtu");
  write("b/block_00000.vtu", vtu.substr(0, vtu.size() / 2));
  expect({"compare", "a", "b"}, 2, "block_00000.vtu");
  std::filesystem::remove(folder_ / "b/block_00000.vtu");
  expect({"compare", "a", "b"}, 4, "block_00000.vtu");
  expect({"compare", "a", "a.toml"}, 4, "is no directory of results");
  expect({"compare", "a"}, 2, "b is required");
}

}  // namespace
}  // namespace fascia::test::compare_test
