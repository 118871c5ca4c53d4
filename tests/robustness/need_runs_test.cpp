// Scenes that state what their results must be worth, as users run them.
#include "tests/robustness/scene_runs.hpp"

namespace fascia::need_runs_test {
namespace {

using namespace fascia::test;
namespace fs = std::filesystem;

/// The small cantilever without frames.
std::string open_beam(const std::string& need) {
  return with(kCantilever, "frames   = { grid = [3, 2, 2] }\n", "") + need;
}

/// Trials are kept in the test's own folder.
class NeedRuns : public SceneRuns {
 protected:
  ProgramResult fascia(const std::vector<std::string>& args, const std::string& cache = "") const {
    ProgramOptions options;
    options.environment = {"XDG_CACHE_HOME=" + (cache.empty() ? (folder_ / "cache").string() : cache)};
    return SceneRuns::fascia(args, options);
  }
  /// Trials of a run's search, and how many of them earlier ones had made.
  std::pair<std::size_t, std::size_t> trials(const std::string& output) const {
    std::size_t all = 0, kept = 0;
    const nlohmann::json j = summary(output);
    for (const nlohmann::json& trial : j.at("need").at("trials")) {
      ++all;
      kept += trial.value("kept", false) ? 1U : 0U;
    }
    return {all, kept};
  }
};

TEST_F(NeedRuns, ChooseFramesThatAreGoodEnough) {
  write("scenes/beam.toml", open_beam("[need]\nerror = \"5 %\"\nprobe = \"tip\"\n"));
  const ProgramResult result = fascia({"run", "scenes/beam.toml", "--output", "out"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json j = summary("out");
  EXPECT_TRUE(j.at("need").at("met").get<bool>());
  EXPECT_EQ(j.at("need").at("error"), 0.05);
  EXPECT_GE(j.at("need").at("trials").size(), 4u);
  EXPECT_GE(j.at("chosen").size(), 3u);
  EXPECT_LE(j.at("estimated_error").at("tip").at("total"), 0.05);
  EXPECT_GT(j.at("estimated_error").at("bodies").at("beam").at("discretisation"), 0);
  EXPECT_NE(result.out.find("chosen: beam: "), std::string::npos) << result.out;
  // The finest that the estimate compares with would be nearer than 5 %.
  const ProgramResult fine = fascia({"run", "scenes/beam.toml", "--output", "fine", "--set", "need=", "--set",
                                     "bodies.beam.frames={ grid = [21, 5, 5], kind = \"affine\" }"});
  ASSERT_EQ(fine.status, 0) << fine.err;
  const double far = j["probes"]["tip"]["value"][1], reference = summary("fine")["probes"]["tip"]["value"][1];
  EXPECT_LE(std::abs(far - reference), 0.05 * std::abs(reference));
  // Without the search: the same numbers.
  const ProgramResult again = fascia({"run", "out/chosen.toml", "--output", "again"});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(summary("again").at("probes"), j.at("probes"));
  EXPECT_FALSE(summary("again").contains("need"));
  EXPECT_EQ(fascia({"rerun", "out"}).status, 0);
}

TEST_F(NeedRuns, KeepTheirTrialsForTheNext) {
  const std::string scene = with(open_beam("[need]\nerror = \"5 %\"\nprobe = \"tip\"\n"), "density  = 1000",
                                 "density  = 1000\nframes = { kind = \"affine\" }");
  const auto run = [&](const std::string& text, const std::string& output, const std::vector<std::string>& more = {},
                       const std::string& cache = "") {
    write("beam.toml", text);
    std::vector<std::string> args{"run", "beam.toml", "--output", output};
    args.insert(args.end(), more.begin(), more.end());
    const ProgramResult result = fascia(args, cache);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  };
  run(scene, "first");
  EXPECT_EQ(trials("first").second, 0u);
  const std::string out = run("# another comment\n" + scene, "second");
  EXPECT_EQ(trials("second").second, trials("first").first);
  EXPECT_EQ(trials("second").first, trials("first").first);
  EXPECT_EQ(summary("second").at("probes"), summary("first").at("probes"));
  EXPECT_EQ(summary("second").at("estimated_error"), summary("first").at("estimated_error"));
  EXPECT_NE(out.find(" were kept from before"), std::string::npos) << out;
  // Another need asks for some more of them at most; another scene, and who wishes so, makes all anew.
  run(with(scene, "5 %", "6 %"), "need");
  EXPECT_GT(trials("need").second, 1u);
  run(with(scene, "density  = 1000", "density  = 1001"), "denser");
  EXPECT_EQ(trials("denser").second, 0u);
  run(scene, "anew", {"--new-trials"});
  EXPECT_EQ(trials("anew").second, 0u);
  run(scene, "nowhere", {}, "/dev/null/none");
  EXPECT_EQ(trials("nowhere").second, 0u);
  // Damaged and empty ones are made again.
  bool empty = false;
  for (const auto& entry : fs::directory_iterator(folder_ / "cache/fascia/trials")) {
    std::ofstream(entry.path()) << (empty ? "" : "{\"status\": \"converged\", ");
    empty = !empty;
  }
  run(scene, "damaged");
  EXPECT_EQ(trials("damaged").second, 0u);
}

/// A study of the small cantilever over its resolution and linear solvers, made by "fascia study".
constexpr const char* kStudy = R"(base = "beam.toml"
repeat = 1
warm_up = 0
[[axes]]
refine = [1, 2, 3]
[[axes]]
key = "solver.linear.kind"
values = ["cholesky", "cg"]
[[measures]]
probe = "tip"
reference = "finest"
)";

TEST_F(NeedRuns, ChooseAmongTheRunsOfAStudy) {
  write("beam.toml", kCantilever);
  write("study.toml", kStudy);
  ASSERT_EQ(fascia({"study", "study.toml", "--output", "study", "--quiet"}).status, 0);
  const nlohmann::json study = nlohmann::json::parse(read_text(folder_ / "study/study.json"));
  const auto needs = [&](const std::string& need) { return open_beam("[need]\nstudy = \"study\"\n" + need); };
  write("need.toml", needs("error = 0.9\nprobe = \"tip\"\n"));
  const ProgramResult result = fascia({"run", "need.toml", "--output", "chosen"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json j = summary("chosen"), &need = j.at("need");
  EXPECT_EQ(need.at("runs").at("of_the_study"), 6);
  EXPECT_EQ(need.at("runs").at("of_this_scene"), 6);
  // The cheapest of all, with the same numbers as in the study.
  double least = INFINITY;
  nlohmann::json cheapest;
  for (const nlohmann::json& run : study.at("runs")) {
    const nlohmann::json& record = run.at("record");
    const double seconds =
        record.at("setup").at("median").get<double>() + record.at("solve").at("median").get<double>();
    if (seconds < least) cheapest = run, least = seconds;
  }
  EXPECT_EQ(need.at("run").at("seconds"), least);
  EXPECT_EQ(j.at("probes").at("tip"), cheapest.at("record").at("probes").at("tip"));
  EXPECT_NE(result.out.find("why: the cheapest that meets the need of 6 runs of study"), std::string::npos)
      << result.out;
  ASSERT_EQ(fascia({"run", "chosen/chosen.toml", "--output", "again"}).status, 0);
  EXPECT_EQ(summary("again").at("probes"), j.at("probes"));
  EXPECT_EQ(fascia({"rerun", "chosen"}).status, 0);
  // Keys that the scene says stay.
  write("cg.toml", with(needs("error = 0.9\n"), "kind = \"static\"", "kind = \"static\"\nlinear = { kind = \"cg\" }"));
  ASSERT_EQ(fascia({"run", "cg.toml", "--output", "cg"}).status, 0);
  EXPECT_EQ(summary("cg").at("need").at("runs").at("of_this_scene"), 3);
  EXPECT_EQ(summary("cg").at("need").at("runs").at("changing_it"), 3);
  // Numbers are the same whether they have a point or not.
  write("point.toml", with(needs("error = 0.9\n"), "density  = 1000", "density  = 1000.0"));
  EXPECT_EQ(fascia({"check", "point.toml"}).status, 0);
  // Beyond what the study holds.
  write("much.toml", needs("error = 1e-9\n"));
  const ProgramResult much = fascia({"run", "much.toml", "--output", "much"});
  EXPECT_EQ(much.status, 3) << much.err;
  EXPECT_NE(much.err.find("much.toml: the need is not met: the nearest of its runs, "), std::string::npos) << much.err;
  EXPECT_FALSE(summary("much").at("need").at("met").get<bool>());
  const ProgramResult check = fascia({"check", "need.toml"});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_NE(check.out.find("chosen: "), std::string::npos) << check.out;

  // Studies that are none, or of something else.
  expect_refused(needs("error = 0.9\nprobe = \"weight\"\n"),
                 {"need.study: ", "no errors of probe \"weight\", but measures \"tip\""});
  expect_refused(with(needs("error = 0.9\n"), "density  = 1000", "density  = 1200"),
                 {"none of the 6 runs of ", "its `bodies.beam.density` is 1000.0 where this scene has 1200.0"});
  expect_refused(with(needs("error = 0.9\n"), "density  = 1000", "density  = 1000\nframes = { grid = [4, 2, 2] }"),
                 {"its `bodies.beam.frames.grid` is [3.0, 2.0, 2.0] where this scene has [4.0, 2.0, 2.0]"});
  expect_refused(with(needs("error = 0.9\n"), "study = \"study\"", "study = \"nowhere\""),
                 {"nowhere/study.json is no file; name the directory that fascia study wrote"});
  write("void/study.json", "");
  expect_refused(with(needs("error = 0.9\n"), "study = \"study\"", "study = \"void\""), {"need.study: ", "empty"});
  write("half/study.json", "{ \"fascia_study\": 1, \"interrupted\": true }\n");
  expect_refused(with(needs("error = 0.9\n"), "study = \"study\"", "study = \"half\""),
                 {"holds no runs; call fascia study again"});
  // The study knows what it ran, whatever became of the file; a study of another scene it is no more.
  write("beam.toml", with(kCantilever, "poisson = 0.3", "poisson = 0.31"));
  write("need.toml", needs("error = 0.9\n"));
  EXPECT_EQ(fascia({"check", "need.toml"}).status, 0);
}

TEST_F(NeedRuns, KeepTheBestWhereANeedCannotBeMet) {
  write("beam.toml", open_beam("[need]\nerror = 1e-6\nmemory = \"41 MB\"\n"));
  const ProgramResult result = fascia({"run", "beam.toml", "--output", "out", "--quiet"});
  EXPECT_EQ(result.status, 3) << result.err;
  EXPECT_NE(result.err.find("beam.toml: the need is not met: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("; reached: estimated error of the displacement of \"beam\""), std::string::npos);
  const nlohmann::json need = summary("out").at("need");
  EXPECT_FALSE(need.at("met").get<bool>());
  EXPECT_FALSE(need.at("why_not").get<std::string>().empty());
  EXPECT_TRUE(fs::exists(folder_ / "out/chosen.toml"));
}

TEST_F(NeedRuns, ChooseTimeSteps) {
  const std::string dynamics = with(open_beam("[need]\nerror = \"10 %\"\n"), "kind = \"static\"", "duration = 0.2");
  write("beam.toml",
        with(dynamics, "density  = 1000", "density = 1000\nframes = { grid = [3, 2, 2], kind = \"affine\" }"));
  const ProgramResult result = fascia({"run", "beam.toml", "--output", "out", "--quiet"});
  EXPECT_NE(result.status, 2) << result.err;
  const nlohmann::json j = summary("out");
  EXPECT_GT(j.at("steps"), 15);
  EXPECT_LT(j.at("estimated_error").at("bodies").at("beam").at("time"), 0.05);
}

TEST_F(NeedRuns, AreCheckedWithWhatIsTriedFirst) {
  write("beam.toml", open_beam("[need]\nerror = \"5 %\"\n"));
  const ProgramResult result = fascia({"check", "beam.toml"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("need: chosen by trials of rigid frames and affine frames of \"beam\"; the first: beam: "
                            "rigid frames"),
            std::string::npos)
      << result.out;
  expect_refused(with(kCantilever, "frames   = { grid = [3, 2, 2] }\n", ""), {"frames: is missing", "[need]"});
  expect_refused(open_beam("[need]\nstep = \"5 ms\"\n"), {"need.step: is a time of steps"});
  expect_refused(with(open_beam("[need]\nerror = 0.01\n"), "body = \"beam\"\nat = [1", "body = \"beam\"\nat = [9"),
                 {"probes.tip.at: "});
}

/// An organ, much stiffer than the stalk that it hangs on, which is clamped.
constexpr const char* kStalked = R"([world]
gravity = [0, -9.81, 0]
[bodies.stalk]
model = "hexahedra"
domain = { box = { min = [0, -0.01, -0.01], max = [0.04, 0.01, 0.01] } }
order = 2
density = 1000
material = { young = "100 kPa", poisson = 0.3 }
[bodies.organ]
model = "hexahedra"
domain = { box = { min = [0.03, -0.02, -0.02], max = [0.07, 0.02, 0.02], cells = [6, 6, 6] } }
order = 1
density = 1000
material = { young = "10 MPa", poisson = 0.3 }
[[constraints]]
body = "stalk"
where = { box = { min = [-1, -1, -1], max = [1e-6, 1, 1] } }
fix = "all"
[couplings.root]
kind = "embed"
body = "stalk"
where = { box = { min = [0.0399, -1, -1], max = [1, 1, 1] } }
to = "organ"
[solver]
kind = "static"
[need]
error = "5 %"
)";

TEST_F(NeedRuns, MakeABodyRigidThatMovesAsAWhole) {
  write("stalked.toml", kStalked);
  const ProgramResult result = fascia({"run", "stalked.toml", "--output", "out"});
  ASSERT_EQ(result.status, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("\"organ\" is rigid, as it moves as a whole: adds "), std::string::npos) << result.out;
  const nlohmann::json j = summary("out"), &error = j.at("estimated_error").at("bodies").at("organ");
  EXPECT_GT(error.at("simplification"), 0);
  EXPECT_LE(error.at("total"), 0.05);
  // It adds to the error as much as it changes.
  const ProgramResult whole =
      fascia({"run", "out/chosen.toml", "--output", "whole", "--set", "bodies.organ.model=\"hexahedra\"", "--set",
              "bodies.organ.order=1", "--set", "bodies.organ.mass=", "--set", "bodies.organ.density=1000", "--set",
              "bodies.organ.material={ young = 1e7, poisson = 0.3 }", "--set",
              "probes.far={ body = \"organ\", quantity = \"max_displacement\" }"});
  ASSERT_EQ(whole.status, 0) << whole.err;
  const ProgramResult rigid = fascia({"run", "out/chosen.toml", "--output", "rigid", "--set",
                                      "probes.far={ body = \"organ\", quantity = \"max_displacement\" }"});
  ASSERT_EQ(rigid.status, 0) << rigid.err;
  const double far = summary("whole").at("probes").at("far").at("value"),
               moved = summary("rigid").at("probes").at("far").at("value");
  EXPECT_NEAR(std::abs(moved - far) / far, error.at("simplification"), 1e-6);
}

TEST_F(NeedRuns, KeepABodyThatIsNotAskedForAsItIs) {
  // Clamped, the organ does not move where it is rigid, and the need names the stalk alone.
  std::string scene = with(kStalked,
                           "[couplings.root]\nkind = \"embed\"\nbody = \"stalk\"\nwhere = { box = { min = [0.0399, -1, "
                           "-1], max = [1, 1, 1] } }\nto = \"organ\"\n",
                           "[[constraints]]\nbody = \"organ\"\nwhere = { box = { min = [0, -1, -1], max = [0.0301, 1, "
                           "1] } }\nfix = \"all\"\n");
  scene = with(with(scene, "[need]\nerror = \"5 %\"\n", ""), "order = 2", "order = 2\nneed = { error = \"5 %\" }");
  write("two.toml", scene);
  const ProgramResult result = fascia({"run", "two.toml", "--output", "out"});
  ASSERT_EQ(result.status, 0) << result.out << result.err;
  EXPECT_EQ(result.out.find("\"organ\" is rigid"), std::string::npos) << result.out;
}

TEST_F(NeedRuns, MakeElementsLinearThatStaySmall) {
  const std::string bone = R"([bodies.bone]
model = "hexahedra"
domain = { box = { min = [0, 0, 0], max = [0.03, 0.03, 0.03] } }
density = 1000
material = { young = "500 MPa", poisson = 0.3 }
[[constraints]]
body = "bone"
where = { box = { min = [-1, -1, -1], max = [1, 1, 1e-6] } }
fix = "all"
[[loads]]
body = "bone"
where = { box = { min = [-1, -1, 0.0299], max = [1, 1, 1] } }
total_force = [0, 0, "-250 N"]
[need]
error = "3 %"
)";
  write("bone.toml", bone);
  const ProgramResult result = fascia({"run", "bone.toml", "--output", "out"});
  ASSERT_EQ(result.status, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("\"bone\" is linear, as its displacements are small: adds "), std::string::npos)
      << result.out;
  EXPECT_EQ(summary("out").at("newton_iterations"), 1);
  // The formulation that a scene says stays.
  write("said.toml", with(bone, "density = 1000", "density = 1000\nformulation = \"st-venant-kirchhoff\""));
  const ProgramResult said = fascia({"run", "said.toml", "--output", "said"});
  EXPECT_EQ(said.out.find("is linear"), std::string::npos) << said.out;
}

TEST_F(NeedRuns, CountErrorsOfCellsThatTheSceneSays) {
  const std::string beside =
      with(with(kCantilever, "frames   = { grid = [3, 2, 2] }\n", ""), "[[constraints]]",
           "[bodies.block]\nmodel = \"hexahedra\"\norder = 1\ndensity = 1000\nmaterial = \"soft\"\n"
           "domain = { box = { min = [0, 0, 1], max = [1, 0.2, 1.2], cells = [2, 1, 1] } }\n"
           "[[constraints]]\nbody = \"block\"\nwhere = { box = { min = [-0.01, -1, -1], max = [0.01, 1, 2] } }\nfix = "
           "\"all\"\n"
           "[[constraints]]");
  write("two.toml", beside + "[need]\nerror = \"10 %\"\n");
  const ProgramResult result = fascia({"run", "two.toml", "--output", "out", "--quiet"});
  EXPECT_EQ(result.status, 3) << result.err;
  EXPECT_NE(result.err.find("the cells of \"block\", which the scene says, have "), std::string::npos) << result.err;
  EXPECT_GT(summary("out").at("estimated_error").at("bodies").at("block").at("total"), 0.1);
}

TEST_F(NeedRuns, GiveEachBodyTheCellsThatItsOwnNeedTakes) {
  const std::string box =
      "model = \"hexahedra\"\norder = 1\ndensity = 1000\nmaterial = { young = \"1 MPa\", poisson = 0.3 }\n"
      "domain = { box = { min = [0, 0, ";
  write(
      "two.toml",
      "[world]\ngravity = [0, -9.81, 0]\n[bodies.a]\nneed = { error = \"60 %\" }\n" + box +
          "0], max = [0.2, 0.1, 0.1] } }\n"
          "[bodies.b]\nneed = { error = \"5 %\" }\n" +
          box +
          "1], max = [0.2, 0.1, 1.1] } }\n"
          "[[constraints]]\nbody = \"a\"\nwhere = { box = { min = [-1, -1, -1], max = [1e-6, 1, 2] } }\nfix = \"all\"\n"
          "[[constraints]]\nbody = \"b\"\nwhere = { box = { min = [-1, -1, -1], max = [1e-6, 1, 2] } }\nfix = "
          "\"all\"\n");
  const ProgramResult result = fascia({"run", "two.toml", "--output", "out"});
  ASSERT_EQ(result.status, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("as the error of \"a\" leaves room: adds "), std::string::npos) << result.out;
  const nlohmann::json errors = summary("out").at("estimated_error").at("bodies");
  EXPECT_LE(errors.at("a").at("total"), 0.6);
  EXPECT_LE(errors.at("b").at("total"), 0.05);
}

TEST(Tune, IgnoresFilesOfOthers) {
  std::string name = (fs::temp_directory_path() / "fascia tune XXXXXX").string();
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  const fs::path folder = name;
  fs::create_directories(folder / "fascia");
  std::ofstream(folder / "beam.toml") << kCantilever;
  ProgramOptions options;
  options.directory = folder;
  options.environment = {"XDG_CACHE_HOME=" + folder.string()};
  const auto check = [&](const std::string& kept) {
    std::ofstream(folder / "fascia/tune.json") << kept;
    const ProgramResult result = run_program({program(), "check", "beam.toml"}, options);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  };
  EXPECT_NE(check("{").find("tune.json is not what fascia tune writes, and is not used"), std::string::npos);
  EXPECT_NE(check(R"({"key": {"processor": "abacus"}, "kinds": {}})").find("is of another machine or version"),
            std::string::npos);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace fascia::need_runs_test
