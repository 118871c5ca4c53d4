#include "tests/robustness/scene_runs.hpp"
#include "tests/support/paths.hpp"

#include <chrono>
#include <fstream>
#include <regex>
#include <set>

namespace fascia::results_test {

// What a result directory holds, and that an older result is lost only to a complete new one.
namespace {

using namespace fascia::test;
namespace fs = std::filesystem;

class Results : public SceneRuns {
 protected:
  void SetUp() override {
    SceneRuns::SetUp();
    write("scene.toml", kCantilever);
    write("dynamics.toml", dynamic_scene());
  }
  void make_result() const { ASSERT_EQ(fascia({"run", "scene.toml", "--output", "out"}).status, 0); }

  /// The same call under a limit on the size of each file written, as a disk that fills up.
  ProgramResult fascia_on_a_full_disk(const std::string& arguments) const {
    ProgramOptions options;
    options.directory = folder_;
    options.environment = {"PROGRAM=" + fascia::test::program()};
    return run_program({"sh", "-c", "trap '' XFSZ; ulimit -f 1; exec \"$PROGRAM\" " + arguments}, options);
  }
};

TEST_F(Results, StaticRunHasOneRowOfProbes) {
  make_result();
  const auto rows = lines_of(read_text(folder_ / "out/probes.csv"));
  ASSERT_GE(rows.size(), 2u);
  EXPECT_EQ(rows[0], "time,tip.x,tip.y,tip.z,weight");
  EXPECT_EQ(std::stod(rows.back()), 1.0) << "load factor as time";
  const auto tip = summary("out").at("probes").at("tip").at("value");
  double time = 0, x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(rows.back().c_str(), "%lf,%lf,%lf,%lf", &time, &x, &y, &z), 4);
  EXPECT_DOUBLE_EQ(x, tip.at(0).get<double>());
  EXPECT_DOUBLE_EQ(y, tip.at(1).get<double>());
  EXPECT_DOUBLE_EQ(z, tip.at(2).get<double>());
}

TEST_F(Results, DynamicRunStartsWithTheRowOfTimeZero) {
  ASSERT_EQ(fascia({"run", "dynamics.toml", "--output", "out"}).status, 0);
  const auto rows = lines_of(read_text(folder_ / "out/probes.csv"));
  ASSERT_EQ(rows.size(), 7u) << "header, time 0, and five saved times";
  EXPECT_TRUE(rows[1].starts_with("0,0,0,0,")) << rows[1];
  for (std::size_t row = 1; row < rows.size(); ++row) {
    EXPECT_NEAR(std::stod(rows[row]), 0.02 * static_cast<double>(row - 1), 1e-12);
  }
  EXPECT_EQ(summary("out").at("steps"), 10);
  EXPECT_NEAR(summary("out").at("simulated_time").get<double>(), 0.1, 1e-12);
}

TEST_F(Results, CollectionListsEveryFileAndNoOther) {
  ASSERT_EQ(fascia({"run", "dynamics.toml", "--output", "out"}).status, 0);
  std::set<std::string> on_disk, listed;
  fs::path collection;
  for (const auto& entry : fs::directory_iterator(folder_ / "out")) {
    if (entry.path().extension() == ".pvd") collection = entry.path();
  }
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "out")) {
    if (entry.path().extension() == ".vtu") on_disk.insert(fs::relative(entry.path(), folder_ / "out").string());
  }
  ASSERT_EQ(collection.filename(), "dynamics.pvd");
  const std::string text = read_text(collection);
  const std::regex file(R"re(file="([^"]*)")re");
  for (auto match = std::sregex_iterator(text.begin(), text.end(), file); match != std::sregex_iterator(); ++match) {
    listed.insert((*match)[1]);
  }
  EXPECT_EQ(listed.size(), 6u) << "one body at six times";
  EXPECT_EQ(listed, on_disk);
}

TEST_F(Results, HoldNoNumberThatIsNotFinite) {
  make_result();
  const std::regex not_finite(R"re((^|[^a-z])-?(nan|inf|null)([^a-z]|$))re", std::regex::icase);
  EXPECT_FALSE(std::regex_search(read_text(folder_ / "out/summary.json"), not_finite));
  EXPECT_FALSE(std::regex_search(read_text(folder_ / "out/probes.csv"), not_finite));
}

TEST_F(Results, PictureKnowsTimesAndSupports) {
  const auto run = fascia({"run", "dynamics.toml", "--output", "out", "--set", "output.picture.size=[200,150]"});
  ASSERT_EQ(run.status, 0);
  if (!fs::exists(folder_ / "out/dynamics.png")) GTEST_SKIP() << "no picture here: " << run.err;
  EXPECT_EQ(read_text(folder_ / "out/dynamics.png").substr(1, 3), "PNG");
  const auto picture = nlohmann::json::parse(read_text(folder_ / "out/picture.json"));
  EXPECT_EQ(picture.at("kind"), "time");
  EXPECT_EQ(picture.at("states").size(), 6u);
  EXPECT_NEAR(picture.at("states").back().get<double>(), 0.1, 1e-12);
  ASSERT_FALSE(picture.at("supports").empty());
  EXPECT_EQ(picture.at("supports")[0].at("body"), "beam");
  make_result();
  EXPECT_FALSE(fs::exists(folder_ / "out/picture.json")) << "it belongs to the older result";
}

TEST_F(Results, PictureNeverReplacesAResult) {
  const fs::path program = build_dir() / "fascia-picture";
  if (!fs::exists(program)) GTEST_SKIP() << "no " << program;
  write("a_00000.vtu", "one result");
  write("b_00000.vtu", "another");
  const auto before = snapshot();
  ProgramOptions options;
  options.directory = folder_;
  const ProgramResult result = run_program({program.string(), "a_00000.vtu", "b_00000.vtu"}, options);
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_NE(result.err.find("b_00000.vtu: the last file is the picture"), std::string::npos) << result.err;
  EXPECT_EQ(snapshot(), before);
}

TEST_F(Results, DisplayIsBlamedOnlyWhereItIsTheReason) {
  if (!fs::exists(build_dir() / "fascia-picture")) GTEST_SKIP() << "no fascia-picture";
  const std::vector<std::string> run = {"run", "scene.toml", "--output",
                                        "out", "--set",      "output.picture.size=[200,150]"};
  const std::string remedy = "a display, or xvfb-run (Debian: xvfb, xauth), is needed";
  ProgramOptions options;
  options.environment = {"DISPLAY=:4321"};
  const ProgramResult silent = fascia(run, options);
  EXPECT_EQ(silent.status, 0) << silent.err;
  EXPECT_NE(silent.err.find("\":4321\" does not answer"), std::string::npos) << silent.err;
  EXPECT_NE(silent.err.find("its message tells why"), std::string::npos) << silent.err;
  EXPECT_EQ(silent.err.find(remedy), std::string::npos) << silent.err;
  options.environment = {"DISPLAY=", "PATH=/nonexistent"};
  const ProgramResult absent = fascia(run, options);
  EXPECT_EQ(absent.status, 0) << absent.err;
  EXPECT_NE(absent.err.find(remedy), std::string::npos) << absent.err;
}

TEST_F(Results, DefaultDirectoryCarriesTheNameOfTheScene) {
  ASSERT_EQ(fascia({"run", "scene.toml"}).status, 0);
  EXPECT_EQ(summary("results/scene").at("status"), "converged");
}

TEST_F(Results, NewResultReplacesTheOldOneAsAWhole) {
  ASSERT_EQ(fascia({"run", "dynamics.toml", "--output", "out"}).status, 0);
  make_result();
  EXPECT_EQ(summary("out").at("scene"), "scene.toml");
  for (const auto& [name, text] : snapshot()) EXPECT_EQ(name.find("out/dynamics"), std::string::npos) << name;
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 3) << "two scenes and the result, nothing left behind";
}

TEST_F(Results, SamplesAreKeptForTheNextRun) {
  write("cloud.toml",
        with(kCantilever, "frames   = { grid = [3, 2, 2] }", "frames = { count = 40 }\npoints = { count = 800 }"));
  const auto run = [&](const std::string& output, const std::string& home, const std::string& cache = "") {
    ProgramOptions options;
    options.environment = {"XDG_CACHE_HOME=" + (folder_ / home).string()};
    std::vector<std::string> args{"run", "cloud.toml", "--output", output, "--quiet"};
    if (!cache.empty()) args.insert(args.end(), {"--set", "output.cache=" + cache});
    const ProgramResult result = fascia(args, options);
    EXPECT_EQ(result.status, 0) << result.err;
    return read_text(folder_ / output / "probes.csv");
  };
  const auto files = [&](const std::string& folder) {
    std::vector<std::filesystem::path> found;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / folder, none)) found.push_back(entry.path());
    return found;
  };
  const std::string probes = run("plain", "none", "false");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
  EXPECT_EQ(run("first", "home"), probes);
  const std::vector<std::filesystem::path> kept = files("home/fascia/samples");
  ASSERT_FALSE(kept.empty());
  // Those that are taken are marked as used.
  const auto long_ago = std::filesystem::file_time_type::clock::now() - std::chrono::hours(1);
  for (const std::filesystem::path& file : kept) std::filesystem::last_write_time(file, long_ago);
  EXPECT_EQ(run("second", "home"), probes);
  for (const std::filesystem::path& file : kept) EXPECT_GT(std::filesystem::last_write_time(file), long_ago);
  run("elsewhere", "none", "samples");
  EXPECT_FALSE(files("samples").empty());
  // Those that are damaged or empty are made again, and where nothing can be written the run goes on.
  for (const std::filesystem::path& file : kept) {
    std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp(-20, std::ios::end);
    stream << "damage";
  }
  EXPECT_EQ(run("damaged", "home"), probes);
  std::ofstream(kept.front(), std::ios::binary) << "";
  EXPECT_EQ(run("empty", "home"), probes);
  write("file", "");
  EXPECT_EQ(run("nowhere", "file"), probes);
}

TEST_F(Results, OldResultOutlivesAWrongScene) {
  make_result();
  const auto before = snapshot();
  EXPECT_EQ(fascia({"run", "scene.toml", "--output", "out", "--set", "materials.soft.young=-1"}).status, 2);
  EXPECT_EQ(fascia({"run", "scene.toml", "--output", "out", "--set", "probes.tip.at=[9, 0, 0]"}).status, 2);
  EXPECT_EQ(fascia({"run", "scene.toml", "--output", "out", "--backend", "cuda", "--set", "solver.control=arc-length"})
                .status,
            5);
  EXPECT_EQ(fascia({"run", "absent.toml", "--output", "out"}).status, 4);
  EXPECT_EQ(snapshot(), before);
}

TEST_F(Results, OldResultOutlivesAFullDisk) {
  make_result();
  const auto before = snapshot();
  const ProgramResult result = fascia_on_a_full_disk("run dynamics.toml --output out");
  EXPECT_EQ(result.status, 4) << result.err;
  EXPECT_FALSE(lines_of(result.err).empty());
  EXPECT_EQ(snapshot(), before);
}

TEST_F(Results, FullDiskLeavesNothingBehind) {
  const auto before = snapshot();
  EXPECT_EQ(fascia_on_a_full_disk("run scene.toml --output out").status, 4);
  EXPECT_EQ(snapshot(), before);
}

TEST_F(Results, FolderThatIsNoResultIsKept) {
  write("thesis/chapter.txt", "years of work");
  write("almost/summary.json", "{ \"author\": \"somebody else\" }");
  write("plain_file", "text");
  const auto before = snapshot();
  for (const char* output : {"thesis", "almost", "plain_file", "."}) {
    const ProgramResult result = fascia({"run", "scene.toml", "--output", output});
    EXPECT_EQ(result.status, 4) << output;
    EXPECT_NE(result.err.find(output), std::string::npos) << result.err;
  }
  EXPECT_EQ(snapshot(), before);
}

TEST_F(Results, EmptyFolderIsFilled) {
  fs::create_directory(folder_ / "out");
  make_result();
  EXPECT_EQ(summary("out").at("status"), "converged");
}

TEST_F(Results, FolderThatCannotBeMadeIsNamed) {
  write("plain_file", "text");
  for (const std::string output : {"plain_file/out", "/proc/fascia/out"}) {
    const ProgramResult result = fascia({"run", "scene.toml", "--output", output});
    EXPECT_EQ(result.status, 4) << output;
    EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
    EXPECT_NE(result.err.find(output.substr(0, output.rfind('/'))), std::string::npos) << result.err;
  }
}

}  // namespace

}  // namespace fascia::results_test
