#include "tests/robustness/scene_runs.hpp"

#include <regex>

namespace fascia::bad_scene_test {

// Wrong scenes: every error on a line of its own with its place, status 2, nothing written.
namespace {

using namespace fascia::test;

struct WrongScene {
  const char* name;
  const char* from;  ///< text of the cantilever that is replaced
  const char* to;
  const char* key;   ///< full path that the error names
  const char* says;  ///< a part of the message
};

void PrintTo(const WrongScene& wrong, std::ostream* out) { *out << wrong.name; }

const WrongScene kWrongScenes[] = {
    {"poisson_too_large", "poisson = 0.3", "poisson = 0.6", "materials.soft.poisson", "0.6"},
    {"young_negative", "\"100 kPa\"", "-1.0", "materials.soft.young", "-1"},
    {"young_zero", "\"100 kPa\"", "0", "materials.soft.young", "0"},
    {"young_nan", "\"100 kPa\"", "nan", "materials.soft.young", "nan"},
    {"young_infinite", "\"100 kPa\"", "inf", "materials.soft.young", "inf"},
    {"unit_of_wrong_dimension", "\"100 kPa\"", "\"100 m\"", "materials.soft.young", "100 m"},
    {"unit_unknown", "\"100 kPa\"", "\"100 kPaa\"", "materials.soft.young", "kPaa"},
    {"wrong_type", "\"100 kPa\"", "[1, 2]", "materials.soft.young", ""},
    {"unknown_key_with_hint", "poisson = 0.3", "poison = 0.3", "materials.soft.poison", "poisson"},
    {"missing_key", "poisson = 0.3", "", "materials.soft", "poisson"},
    {"missing_mass", "density  = 1000", "", "bodies.beam", "density"},
    {"mass_and_density", "density  = 1000", "density = 1000\nmass = 1", "bodies.beam", "mass"},
    {"material_unknown", "material = \"soft\"", "material = \"sotf\"", "bodies.beam.material", "soft"},
    {"rigid_with_frames", "\"meshless\"", "\"rigid\"", "bodies.beam.frames", "is not used"},
    {"surface_with_density", "\"meshless\"", "\"surface\"", "bodies.beam.density", "is not used"},
    {"surface_alone", "\"meshless\"", "\"surface\"", "bodies.beam", "rides on nothing"},
    {"shell_with_frames", "\"meshless\"", "\"shell\"", "bodies.beam.frames", "is not used"},
    {"tetrahedra_without_cells", "\"meshless\"", "\"tetrahedra\"", "bodies.beam.domain.box.cells", "is missing"},
    {"tetrahedra_with_frames", "\"meshless\"", "\"tetrahedra\"", "bodies.beam.frames", "is not used"},
    {"hexahedra_with_locking", "\"meshless\"", "\"hexahedra\"\nlocking = \"f-bar\"", "bodies.beam.locking",
     "is not used"},
    {"meshless_with_cells", "max = [1, 0.2, 0.2]", "max = [1, 0.2, 0.2], cells = [5, 1, 1]",
     "bodies.beam.domain.box.cells", "is not used"},
    {"meshless_with_formulation", "material = \"soft\"", "material = \"soft\"\nformulation = \"linear\"",
     "bodies.beam.formulation", "is not used"},
    {"meshless_block_with_cells", "box = { min = [0, 0, 0], max = [1, 0.2, 0.2] }",
     "block = { corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], "
     "cells = [1, 1, 1] }",
     "bodies.beam.domain.block.cells", "is not used"},
    {"block_inverted", "box = { min = [0, 0, 0], max = [1, 0.2, 0.2] }",
     "block = { corners = [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0], [0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]], "
     "cells = [1, 1, 1] }",
     "bodies.beam.domain.block.corners", "counter-clockwise"},
    {"law_unknown", "poisson = 0.3", "poisson = 0.3\nlaw = \"neohookean\"", "materials.soft.law", "neo-hookean"},
    {"model_unknown", "\"meshless\"", "\"mesh-less\"", "bodies.beam.model", "meshless"},
    {"grid_too_small", "grid = [3, 2, 2]", "grid = [1, 2, 2]", "bodies.beam.frames.grid", ""},
    {"grid_of_two_numbers", "grid = [3, 2, 2]", "grid = [3, 2]", "bodies.beam.frames.grid", "3"},
    {"grid_of_fractions", "grid = [3, 2, 2]", "grid = [3.5, 2, 2]", "bodies.beam.frames.grid", "3.5"},
    {"grid_too_large_for_memory", "grid = [3, 2, 2]", "grid = [300, 200, 160]", "bodies.beam.frames.grid", "GB"},
    {"grid_with_seed", "grid = [3, 2, 2]", "grid = [3, 2, 2], seed = 3", "bodies.beam.frames.seed", "poisson_disk"},
    {"grid_with_scattered_points", "material = \"soft\"", "material = \"soft\"\npoints = { count = 50 }",
     "bodies.beam.points.count", "per_cell"},
    {"grid_with_scattered_weights", "material = \"soft\"", "material = \"soft\"\nweights = { kind = \"mls\" }",
     "bodies.beam.weights.kind", "trilinear"},
    {"grid_with_neighbours", "material = \"soft\"", "material = \"soft\"\nweights = { neighbours = 8 }",
     "bodies.beam.weights.neighbours", "scattered"},
    {"two_kinds_of_frames", "grid = [3, 2, 2]", "grid = [3, 2, 2], count = 20", "bodies.beam.frames.count", "grid"},
    {"no_frames", "grid = [3, 2, 2]", "kind = \"rigid\"", "bodies.beam.frames", "poisson_disk"},
    {"share_of_itself", "grid = [3, 2, 2]", "count = 20, share = [{ body = \"beam\" }]",
     "bodies.beam.frames.share[0].body", "is the body itself"},
    {"share_of_unknown", "grid = [3, 2, 2]", "count = 20, share = [{ body = \"bone\" }]",
     "bodies.beam.frames.share[0].body", "no known body"},
    {"between_unknown", "box = { min = [0, 0, 0], max = [1, 0.2, 0.2] }", "between = [\"bone\", \"beam\"]",
     "bodies.beam.domain.between[0]", "no known body"},
    {"spacing_zero", "grid = [3, 2, 2]", "poisson_disk = 0", "bodies.beam.frames.poisson_disk", "above 0"},
    {"count_zero", "grid = [3, 2, 2]", "count = 0", "bodies.beam.frames.count", "1"},
    {"rotations_too_few", "grid = [3, 2, 2]", "positions = [[0, 0, 0], [1, 0, 0]], rotations = [[0, 0, 0]]",
     "bodies.beam.frames.rotations", "positions"},
    {"box_with_thickness", "material = \"soft\"", "material = \"soft\"\nthickness = 0.1", "bodies.beam.thickness",
     "solid"},
    {"box_with_points_through", "material = \"soft\"", "material = \"soft\"\npoints = { through = 2 }",
     "bodies.beam.points.through", "sheets"},
    {"rectangle_without_thickness", "box = { min = [0, 0, 0], max = [1, 0.2, 0.2] }",
     "rectangle = { origin = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] }", "bodies.beam.thickness", "missing"},
    {"rectangle_without_area", "box = { min = [0, 0, 0], max = [1, 0.2, 0.2] }",
     "rectangle = { origin = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [2, 0, 0] }",
     "bodies.beam.domain.rectangle.edge_v", "parallel"},
    {"line_without_radius", "box = { min = [0, 0, 0], max = [1, 0.2, 0.2] }",
     "line = { from = [0, 0, 0], to = [1, 0, 0] }", "bodies.beam.radius", "missing"},
    {"line_without_length", "box = { min = [0, 0, 0], max = [1, 0.2, 0.2] }",
     "line = { from = [0, 0, 0], to = [0, 0, 0] }", "bodies.beam.domain.line.to", "another point"},
    {"line_of_1e155_m", "box = { min = [0, 0, 0], max = [1, 0.2, 0.2] }",
     "line = { from = [0, 1e155, 0], to = [1, 0, 0] }", "bodies.beam.domain.line.from[1]", "at most 1e+50 m"},
    {"box_of_1e155_m", "max = [1, 0.2, 0.2] }", "max = [1e155, 0.2, 0.2] }", "bodies.beam.domain.box.max[0]",
     "at most 1e+50 m"},
    {"ball_of_1e_minus_155_m", "box = { min = [0, 0, 0], max = [1, 0.2, 0.2] }",
     "sphere = { center = [0, 0, 0], radius = 1e-155 }", "bodies.beam.domain.sphere.radius", "at least 1e-50 m"},
    {"box_of_1e_minus_120_m", "max = [1, 0.2, 0.2] }", "max = [1e-120, 1e-120, 1e-120] }", "bodies.beam.domain",
     "m across"},
    {"scaled_to_1e155_m", "density  = 1000", "density = 1000\ntransform = { scale = 1e155 }", "bodies.beam.domain",
     "m across"},
    {"box_turned_round", "min = [0, 0, 0], max = [1, 0.2, 0.2]", "min = [1, 0, 0], max = [0, 0.2, 0.2]",
     "bodies.beam.domain.box", ""},
    {"region_selects_nothing", "min = [-0.01, -1, -1], max = [0.01, 1, 1]", "min = [7, 7, 7], max = [8, 8, 8]",
     "constraints[0].where", ""},
    {"constraint_on_no_body", "body  = \"beam\"", "body  = \"bean\"", "constraints[0].body", "beam"},
    {"fix_unknown_axis", "fix   = \"all\"", "fix = [\"x\", \"q\"]", "constraints[0].fix", "q"},
    {"probe_outside", "at = [1, 0.1, 0.1]", "at = [2, 0.1, 0.1]", "probes.tip.at", "1"},
    {"solver_unknown", "kind = \"static\"", "kind = \"statik\"", "solver.kind", "static"},
    {"budget_of_statics", "kind = \"static\"", "kind = \"static\"\nbudget = \"5 ms\"", "solver.budget",
     "is for steps of implicit dynamics"},
    {"budget_below_zero", "kind = \"static\"", "kind = \"newmark\"\ntime_step = 1\nsteps = 1\nbudget = \"-5 ms\"",
     "solver.budget", "above 0"},
    {"budget_of_no_time", "kind = \"static\"", "kind = \"newmark\"\ntime_step = 1\nsteps = 1\nbudget = \"5 mm\"",
     "solver.budget", "mm"},
    {"budget_under_a_need", "kind = \"static\"",
     "kind = \"newmark\"\nduration = 1\nbudget = \"5 ms\"\n[need]\nerror = \"5 %\"\nprobe = \"tip\"", "solver.budget",
     "need.step"},
    {"explicit_with_newton", "kind = \"static\"",
     "kind = \"explicit\"\ntime_step = 1\nsteps = 1\nnewton = { tolerance = 0.1 }", "solver.newton", "is not used"},
    {"explicit_auto_without_duration", "kind = \"static\"", "kind = \"explicit\"\ntime_step = \"auto\"\nsteps = 3",
     "solver.steps", "duration"},
    {"newmark_with_automatic_step", "kind = \"static\"", "kind = \"newmark\"\ntime_step = \"auto\"\nduration = 1",
     "solver.time_step", "explicit"},
    {"time_step_missing", "kind = \"static\"", "kind = \"implicit-euler\"\nsteps = 3", "solver", "time_step"},
    {"pressure_on_no_face", "[solver]",
     "[[loads]]\nbody = \"beam\"\nwhere = { box = { min = [0.4, -1, -1], max = [0.6, 1, 1] } }\npressure = 1\n[solver]",
     "loads[0].where", "no face"},
    {"pressure_at_a_point", "[solver]", "[[loads]]\nbody = \"beam\"\nat = [1, 0.1, 0.1]\npressure = 1\n[solver]",
     "loads[0].pressure", "with where"},
    {"line_force_on_no_edge", "[solver]",
     "[[loads]]\nbody = \"beam\"\nwhere = { box = { min = [0.4, -1, -1], max = [0.45, 1, 1] } }\nline_force = [0, 0, "
     "1]\n[solver]",
     "loads[0].where", "no edge"},
    {"line_force_on_faces", "[solver]", "[[loads]]\nbody = \"beam\"\nwhere = \"all\"\nline_force = [0, 0, 1]\n[solver]",
     "loads[0].where", "traction"},
    {"fluid_in_an_open_sheet",
     "box = { min = [0, 0, 0], max = [1, 0.2, 0.2] } }\ndensity  = 1000\nmaterial = \"soft\"\nframes   = { grid = [3, "
     "2, 2] }",
     "rectangle = { origin = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 0.2, 0] } }\nthickness = 0.01\ndensity = "
     "1\nmaterial = \"soft\"\nframes = { grid = [3, 2] }\nfluid = { pressure = 1 }",
     "bodies.beam.fluid", "is open: "},
    {"fluid_without_pressure", "material = \"soft\"", "material = \"soft\"\nfluid = { density = 1000 }",
     "bodies.beam.fluid", "bulk_modulus"},
    {"fluid_volume_without_modulus", "material = \"soft\"", "material = \"soft\"\nfluid = { pressure = 1, volume = 2 }",
     "bodies.beam.fluid.volume", "bulk_modulus"},
    {"probe_of_no_fluid", "quantity = \"mass\"", "quantity = \"fluid_volume\"", "probes.weight", "there is none"},
    {"free_body", "fix   = \"all\"", "fix   = [\"x\"]", "bodies.beam", "translation along y"}};

class BadScene : public SceneRuns, public ::testing::WithParamInterface<WrongScene> {};

/// The lines of `text` that are "FILE:LINE:COLUMN: key.path: message".
std::vector<std::string> error_lines(const std::string& text) {
  const std::regex form(R"re([^:]*scene\.toml:\d+:\d+: [A-Za-z0-9_.\[\]-]+: .+)re");
  std::vector<std::string> errors;
  for (const std::string& line : lines_of(text)) {
    if (std::regex_match(line, form)) errors.push_back(line);
  }
  return errors;
}

TEST_P(BadScene, IsRefusedWithItsPlace) {
  const WrongScene& wrong = GetParam();
  write("scene.toml", with(kCantilever, wrong.from, wrong.to));
  const auto before = snapshot();
  for (const char* command : {"run", "check"}) {
    const ProgramResult result = fascia({command, "scene.toml"});
    EXPECT_EQ(result.status, 2) << command;
    const auto errors = error_lines(result.err);
    ASSERT_FALSE(errors.empty()) << result.err;
    EXPECT_EQ(errors.size(), lines_of(result.err).size()) << "one line an error: " << result.err;
    bool found = false;
    for (const std::string& error : errors) {
      const std::size_t key = error.find(std::string(": ") + wrong.key);
      found = found || (key != std::string::npos && error.find(wrong.says, key + 2) != std::string::npos);
    }
    EXPECT_TRUE(found) << "no error on " << wrong.key << " that says '" << wrong.says << "':\n" << result.err;
  }
  EXPECT_EQ(snapshot(), before);
}

INSTANTIATE_TEST_SUITE_P(Scenes, BadScene, ::testing::ValuesIn(kWrongScenes),
                         [](const auto& instance) { return instance.param.name; });

using BadScenes = SceneRuns;

TEST_F(BadScenes, AllErrorsAreReportedInOneGo) {
  std::string text = with(kCantilever, "poisson = 0.3", "poisson = 0.6");
  text = with(text, "fix   = \"all\"", "fixed = \"all\"");
  text = with(text, "quantity = \"mass\"", "quantity = \"masses\"");
  write("scene.toml", text);
  const ProgramResult result = fascia({"run", "scene.toml"});
  EXPECT_EQ(result.status, 2);
  for (const char* key : {"materials.soft.poisson", "constraints[0].fixed", "probes.weight.quantity"}) {
    EXPECT_NE(result.err.find(std::string(": ") + key + ": "), std::string::npos) << key << "\n" << result.err;
  }
  const std::string place = "scene.toml:" + place_of(text, "0.6") + ": materials.soft.poisson: ";
  EXPECT_NE(result.err.find(place), std::string::npos) << place << "\n" << result.err;
}

TEST_F(BadScenes, TextThatIsNoTomlIsRefusedWithItsPlace) {
  const std::string scene = kCantilever;
  const std::vector<std::string> texts = {"gravity = = 3\n",
                                          "[world\n",
                                          scene.substr(0, scene.find("[0, -1, 0]") + 5),
                                          std::string("\x7f"
                                                      "ELF\x02\x01\x01\0\0\xff\xfe",
                                                      12),
                                          std::string(5000, '['),
                                          scene + scene};
  for (const std::string& text : texts) {
    write("scene.toml", text);
    const auto before = snapshot();
    const ProgramResult result = fascia({"run", "scene.toml"});
    EXPECT_EQ(result.status, 2) << text.substr(0, 40);
    EXPECT_TRUE(result.err.starts_with("scene.toml:")) << result.err;
    EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
    EXPECT_EQ(snapshot(), before);
  }
}

TEST_F(BadScenes, EmptySceneIsRefused) {
  write("scene.toml", "");
  const ProgramResult result = fascia({"run", "scene.toml"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err, "");
}

TEST_F(BadScenes, BodyWithoutSupportIsNamedWithItsFreeMotion) {
  write("scene.toml", with(kCantilever, "fix   = \"all\"", "fix   = [\"x\"]"));
  const ProgramResult result = fascia({"run", "scene.toml"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("beam"), std::string::npos) << result.err;
  EXPECT_TRUE(std::regex_search(result.err, std::regex("translation|translate|move|motion"))) << result.err;
}

TEST_F(BadScenes, TablesOfFramesAreNamedWithTheirPlace) {
  write("scene.toml", with(kCantilever, "grid = [3, 2, 2]", "file = \"frames.csv\""));
  EXPECT_EQ(fascia({"run", "scene.toml"}).status, 4);
  write("frames.csv", "x,y,z\n0,0,oops\n");
  const auto before = snapshot();
  const ProgramResult result = fascia({"run", "scene.toml"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("frames.csv:2:5: z is \"oops\"; must be a finite number"), std::string::npos) << result.err;
  EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
  EXPECT_EQ(snapshot(), before);
}

/// All integration points lie in the far part of the beam, so the frames of the near part are left out.
TEST_F(BadScenes, HeldMaterialThatNoFrameMovesIsNamed) {
  std::string points = "x,y,z\n";
  for (int n = 0; n < 160; ++n)
    points += std::to_string(0.62 + 0.04 * (n % 10)) + "," + std::to_string(0.025 + 0.05 * (n / 10 % 4)) + "," +
              std::to_string(0.025 + 0.05 * (n / 40)) + "\n";
  write("points.csv", points);
  const std::string text =
      with(kCantilever, "grid = [3, 2, 2] }", "poisson_disk = 0.1 }\npoints = { file = \"points.csv\" }");
  write("scene.toml", text);
  const ProgramResult result = fascia({"run", "scene.toml"});
  EXPECT_EQ(result.status, 2);
  const std::string place = "scene.toml:" + place_of(text, "[[constraints]]") + ": constraints[0]: holds material at (";
  EXPECT_NE(result.err.find(place), std::string::npos) << result.err;
}

TEST_F(BadScenes, GridTooLargeIsRefusedAtOnce) {
  write("scene.toml", with(kCantilever, "grid = [3, 2, 2]", "grid = [300, 200, 160]"));
  ProgramOptions options;
  options.timeout = std::chrono::seconds(10);
  EXPECT_EQ(fascia({"run", "scene.toml"}, options).status, 2);
}

}  // namespace

}  // namespace fascia::bad_scene_test
