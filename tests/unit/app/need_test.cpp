#include "app/machine.hpp"
#include "app/need/accuracy.hpp"
#include "app/need/chosen.hpp"
#include "app/need/open_scene.hpp"
#include "app/need/stored_study.hpp"
#include "app/need/trials.hpp"
#include "app/reader/scene_tree.hpp"
#include "app/results/provenance.hpp"
#include "app/scene/toml_text.hpp"
#include "app/tune/kept_costs.hpp"
#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

// Scenes that state what their results must be worth: what they may leave out, what that leaves open, and how errors
// are judged.
namespace fascia::app::need_test {
namespace {

using test::beam_with;
using test::errors_of;
using test::errors_of_beam;
using test::parse;

constexpr const char* frames = "frames = { grid = [5, 2, 2] }\n";
constexpr const char* need = "[need]\nerror = \"2 %\"\n";

std::string open_beam(const std::string& more = need) { return beam_with(frames, "") + more; }

TEST(Need, FramesMayBeLeftOut) {
  const Scene scene = parse(open_beam());
  EXPECT_NEAR(*scene.need->error, 0.02, 1e-15);
  EXPECT_TRUE(scene.bodies[0].open);
  EXPECT_TRUE(parse(beam_with("{ grid = [5, 2, 2] }", "{ kind = \"affine\" }") + need).bodies[0].open);
  EXPECT_EQ(
      errors_of(beam_with("{ grid = [5, 2, 2] }", "{ kind = \"affine\" }")),
      "a.toml:9:10: bodies.beam.frames: grid, poisson_disk, count, positions or file is missing; give exactly one");
  EXPECT_TRUE(parse(open_beam("need = { error = 0.01 }\n")).bodies[0].need);
}

TEST(Need, CellsMayBeLeftOut) {
  const std::string box = test::mesh_body("hexahedra", "box = { min = [0, 0, 0], max = [4, 1, 1] }");
  EXPECT_TRUE(parse(box + need).bodies[0].open);
  EXPECT_NE(errors_of(box).find("cells: is missing"), std::string::npos);
  EXPECT_TRUE(parse(test::shell_body("sphere = { center = [0, 0, 0], radius = 1 }", "thickness = 0.1\n") + need)
                  .bodies[0]
                  .open);
}

TEST(Need, Contradictions) {
  EXPECT_EQ(
      errors_of(open_beam("[need]\nerror = 0.01\nstep = \"5 ms\"\n")),
      "a.toml:11:8: need.step: is a time of steps, and solver.kind = \"static\" takes none; remove it, or ask for "
      "dynamics");
  EXPECT_EQ(errors_of(open_beam("[need]\nerror = 0.01\nprobe = \"tip\"\n")),
            "a.toml:11:9: need.probe: \"tip\" is no probe, as the scene has none; remove it, or add [probes.tip]");
  EXPECT_EQ(errors_of(open_beam("[need]\nmemory = \"1 GB\"\n")),
            "a.toml:9:1: need: error or step is missing; give one at least");
  EXPECT_EQ(errors_of(open_beam("[need]\nerror = 1.5\n")),
            "a.toml:10:9: need.error: 1.5 is out of range; must be above 0 and below 1");
  EXPECT_EQ(errors_of_beam("[solver]\nkind = \"modes\"\n[need]\nerror = 0.01\n"),
            "a.toml:12:1: need: cannot be stated with solver.kind = \"modes\" yet; say frames and cells, and use "
            "output.estimate");
  EXPECT_EQ(errors_of(beam_with("{ grid = [5, 2, 2] }", "{ grid = [5, 2, 2], kind = \"rigid\" }") + need),
            "a.toml:10:1: need: leaves nothing to choose, as the scene says frames, cells, orders and steps itself; "
            "remove some of them, or remove the need and ask for output.estimate");
}

TEST(Need, StepsAndSchemes) {
  const Scene open = parse(open_beam("[solver]\nduration = \"1 s\"\n[need]\nerror = 0.01\n"));
  EXPECT_TRUE(open.solver.scheme_open);
  EXPECT_TRUE(open.solver.step_open);
  const Scene fixed =
      parse(open_beam("[solver]\nkind = \"bdf2\"\nduration = 1\ntime_step = 0.1\n[need]\nstep = \"5 ms\"\n"));
  EXPECT_FALSE(fixed.solver.scheme_open || fixed.solver.step_open);
  EXPECT_EQ(errors_of(open_beam("[solver]\nkind = \"bdf2\"\nsteps = 3\n[need]\nerror = 0.01\n")),
            "a.toml:11:9: solver.steps: says nothing without time_step, which the need chooses; must be duration");
}

TEST(Pattern, CellsAreAboutAsLongAsWide) {
  EXPECT_EQ(pattern_of({1, 1, 1}, 4, 8), (std::vector{1, 1, 1}));
  EXPECT_EQ(pattern_of({16, 1, 1}, 4, 8), (std::vector{4, 1, 1}));
  EXPECT_EQ(pattern_of({10, 10, 0.1}, 4, 8), (std::vector{8, 8, 1}));
  EXPECT_EQ(pattern_of({2, 1}, 1, 8), (std::vector{2, 1}));
}

TEST(OpenScene, SaysWhatMakesAChoice) {
  const OpenScene open =
      open_parts(parse(test::mesh_body("hexahedra", "box = { min = [0, 0, 0], max = [16, 1, 1] }") + need));
  EXPECT_EQ(open.families(), 2);
  EXPECT_EQ(open.overrides({1, 2}),
            (std::vector<std::string>{"bodies.block.order=2", "bodies.block.domain.box.cells=[8, 2, 2]"}));
  EXPECT_EQ(open.text({0, 2}), "block: linear hexahedra, 8 x 2 x 2 cells");
  const OpenScene beam = open_parts(parse(open_beam()));
  EXPECT_EQ(beam.overrides({1, 2}),
            (std::vector<std::string>{"bodies.beam.frames.kind=\"affine\"", "bodies.beam.frames.grid=[3, 3, 3]"}));
}

TEST(OpenScene, FixedCellsOnlyTellErrors) {
  const OpenScene open = open_parts(parse(test::mesh_body("hexahedra", test::meshed_box) + need));
  EXPECT_FALSE(open.resizes());
  EXPECT_TRUE(open.offers({0, 1}));
  EXPECT_FALSE(open.offers({0, 2}));
  EXPECT_TRUE(open.takes({0, 2}));
}

Series number(double v) { return {{0}, {{v}}}; }

TEST(Convergence, OfAPower) {
  const Series a = number(1 + 0.16), b = number(1 + 0.04), c = number(1 + 0.01);
  const auto two = convergence_of({1, 0.5}, {&a, &b}, 2), three = convergence_of({1, 0.5, 0.25}, {&a, &b, &c}, 2);
  EXPECT_NEAR(two->limit.values[0][0], 1, 1e-12);
  EXPECT_NEAR(two->uncertainty, 0.04, 1e-12);  // as much as was added
  EXPECT_NEAR(three->limit.values[0][0], 1, 1e-12);
  EXPECT_NEAR(three->uncertainty, 0.25 * 0.01, 1e-12);
  EXPECT_TRUE(three->measured);
}

TEST(Convergence, ClaimsNothingOfValuesThatSwing) {
  const Series a = number(1), b = number(1.2), c = number(1.1);
  const auto found = convergence_of({1, 0.5, 0.25}, {&a, &b, &c}, 2);
  EXPECT_FALSE(found->measured);
  EXPECT_NEAR(found->limit.values[0][0], 1.1, 1e-12);
  EXPECT_NEAR(found->uncertainty, 1.5 * 0.1 / 1.1, 1e-12);
}

TEST(ChosenScene, ReadsBackWithTheChoice) {
  const Scene scene =
      parse(open_beam("[output]\ndirectory = \"elsewhere\"\n[probes.mass]\nquantity = \"mass\"\n" + std::string(need)));
  const std::string text = chosen_scene(scene, {"need=", "bodies.beam.frames.grid=[5, 2, 2]"}, {"why"}, "results");
  EXPECT_TRUE(text.starts_with("# why\n"));
  const Scene read = parse(text);
  EXPECT_FALSE(read.states_need());
  EXPECT_EQ(std::get<GridFrames>(read.bodies[0].frames).count, (std::vector{5, 2, 2}));
  EXPECT_EQ(read.probes[0].name, "mass");
  EXPECT_FALSE(read.says("output.directory"));
}

std::string digest_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return simulation_digest(parse(text, overrides));
}

TEST(SimulationDigest, IsOfWhatIsSimulated) {
  const std::string scene(test::beam), digest = digest_of(scene);
  EXPECT_EQ(digest.size(), 16u);
  EXPECT_EQ(digest_of("# a comment\ntitle = \"beam\"\n" + scene), digest);
  EXPECT_EQ(digest_of(scene + "[probes.mass]\nquantity = \"mass\"\n[output]\ndirectory = \"there\"\n" + need), digest);
  EXPECT_EQ(digest_of(beam_with("young = \"40 kPa\"\npoisson = 0.3", "poisson = 0.3\nyoung = \"40 kPa\"")), digest);
  EXPECT_EQ(digest_of(beam_with("mass = \"5 kg\"", "mass = \"4 kg\""), {"bodies.beam.mass=\"5 kg\""}), digest);
  EXPECT_NE(digest_of(scene, {"materials.soft.poisson=0.31"}), digest);
  EXPECT_NE(digest_of(scene, {"solver.newton.tolerance=1e-3"}), digest);
}

Value plain(const std::string& text, const std::vector<std::string>& changes = {}) {
  return plain_tree(parse(text), changes);
}

TEST(TreeDifference, IsTheFirstKeyThatDiffers) {
  const std::string scene(test::beam);
  const Value a = plain(scene), other = plain(scene, {"bodies.beam.mass=\"4 kg\""}),
              more = plain(scene, {"solver.newton.tolerance=1e-3"});
  EXPECT_FALSE(tree_difference(a, plain(scene, {"bodies.beam.frames.grid=[5.0, 2, 2]"}), true));
  EXPECT_EQ(tree_difference(a, other, true)->key, "bodies.beam.mass");
  EXPECT_EQ(tree_difference(a, other, true)->second, "\"4 kg\"");
  EXPECT_FALSE(tree_difference(a, more, false));
  EXPECT_EQ(tree_difference(a, more, true)->key, "solver");
  EXPECT_EQ(tree_difference(more, a, false)->second, "");
  EXPECT_EQ(possible_changes(parse(scene), {"bodies.beam.points=", "solver.kind=\"static\"", "solver.kind="}),
            (std::vector<std::string>{"solver.kind=\"static\"", "solver.kind="}));
  EXPECT_EQ(toml_text(*value_at(a, "bodies.beam.frames.grid")), "[5.0, 2.0, 2.0]");
  EXPECT_EQ(value_at(a, "bodies.beam.order"), nullptr);
}

TEST(TunedGrowth, IsOfTheMethodThatSolvesEachSize) {
  namespace fs = std::filesystem;
  std::string name = (fs::temp_directory_path() / "fascia costs XXXXXX").string();
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  setenv("XDG_CACHE_HOME", name.c_str(), 1);
  KindCost cost;
  cost.point = 1e-6, cost.factor = 2e-9, cost.exponent = 1.5, cost.product = 3e-10, cost.spread = 10;
  CostModel costs;
  costs.kinds["hexahedra"] = cost;
  fs::create_directories(tune_file().parent_path());
  std::ofstream(tune_file()) << nlohmann::ordered_json{{"key", machine_key(this_machine())}, {"kinds", costs.json()}};
  const Scene scene =
      parse(test::mesh_body("hexahedra", "box = { min = [0, 0, 0], max = [4, 1, 1] }", "order = 1\n") + need);
  const Trials trials(scene, open_parts(scene), wanted_of(scene), {}, nullptr, {}, [] { return false; });
  Trial trial;
  trial.choice = {{0, 1}, 0, "", {}};
  trial.dofs = 8000, trial.points = 16000;
  const double own = 1e-6 * 16000 + 2e-9 * std::pow(8000, 1.5);
  EXPECT_NEAR(*trials.tuned_growth(trial, 1.2), (1e-6 * 19200 + 2e-9 * std::pow(9600, 1.5)) / own, 1e-12);
  // Above 10,000 unknowns conjugate gradients solve, which are the cheaper.
  EXPECT_NEAR(*trials.tuned_growth(trial, 2), (1e-6 * 32000 + 3e-10 * 16000 * 10 * std::cbrt(16000.0)) / own, 1e-12);
  // In implicit dynamics from 500 unknowns on, conjugate gradients come first; explicit steps solve nothing.
  const auto growth = [&](const std::string& kind) {
    const std::string solver = "[solver]\nkind = \"" + kind + "\"\nduration = \"1 s\"\ntime_step = \"1 ms\"\n";
    const Scene run = parse(scene.text + solver);
    return *Trials(run, open_parts(run), wanted_of(run), {}, nullptr, {}, [] {
              return false;
            }).tuned_growth(trial, 1.2);
  };
  trial.dofs = 500.5;
  const auto cg = [](double dofs) { return 3e-10 * dofs * 10 * std::cbrt(dofs); };
  EXPECT_NEAR(growth("newmark"), (1e-6 * 19200 + cg(600.6)) / (1e-6 * 16000 + cg(500.5)), 1e-12);
  EXPECT_NEAR(growth("explicit"), 1.2, 1e-12);
  unsetenv("XDG_CACHE_HOME");
  fs::remove_all(name);
}

/// Three runs, the dearer the better.
StoredStudy three_runs() {
  StoredStudy study;
  study.runs = {{"coarse", {}, 0.05, 1, 1e-3, 1e8, 100},
                {"middle", {}, 0.02, 2, 3e-3, 2e8, 200},
                {"fine", {}, 0.01, 4, 2e-3, 4e8, 400}};
  return study;
}

TEST(StudiedChoice, IsTheCheapestThatMeetsTheNeed) {
  const auto first = [](const StatedNeed& stated) { return choose_of_study(three_runs(), stated).runs.front(); };
  EXPECT_EQ(first({.error = 0.03}), 1u);
  EXPECT_EQ(first({.error = 0.03, .step = 2.5e-3}), 2u);
  EXPECT_EQ(first({.step = 5e-3}), 2u);  // the most accurate
  EXPECT_EQ(first({.step = 2e-3}), 0u);
  EXPECT_EQ(first({.error = 0.06, .memory = 1.5e8}), 0u);
  // Those that would be tried after it have shorter steps.
  EXPECT_EQ(choose_of_study(three_runs(), {.error = 0.03, .step = 5e-3}).runs, (std::vector<std::size_t>{1, 2}));
}

TEST(StudiedChoice, IsTheNearestWhereNoneMeetsTheNeed) {
  const StudiedChoice error = choose_of_study(three_runs(), {.error = 0.001});
  EXPECT_EQ(error.runs, std::vector<std::size_t>{2});
  EXPECT_EQ(error.why_not, "the nearest of its runs, fine, has 10 times the error that is allowed");
  const StudiedChoice step = choose_of_study(three_runs(), {.error = 0.03, .step = 1e-3});
  EXPECT_EQ(step.runs, std::vector<std::size_t>{0});  // 1.7 times the error, against 2.3 times the step
  const StudiedChoice memory = choose_of_study(three_runs(), {.step = 1e-2, .memory = 5e7});
  EXPECT_EQ(memory.why_not, "the nearest of its runs, coarse, took 0.1 GB of memory");
}

}  // namespace
}  // namespace fascia::app::need_test
