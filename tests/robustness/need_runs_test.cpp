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

class NeedRuns : public SceneRuns {};

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
