// fascia verify as users and their scripts meet it.
#include "tests/robustness/scene_runs.hpp"

#include <csignal>
#include <set>

namespace fascia::verify_test {
namespace {

using namespace fascia::test;

/// A run of the small cantilever and one case of its mass, 40 kg.
std::string run_of(const std::string& name, double mass, const std::string& more = "") {
  return "[[runs]]\nname = \"" + name +
         "\"\ntitle = \"A <small> beam\"\nfeatures = [\"beam\"]\nfile = \"../beam.toml\"\n" + more +
         "[[runs.cases]]\nname = \"" + name +
         "-mass\"\ntitle = \"mass\"\nprobe = \"weight\"\nvalue = " + std::to_string(mass) +
         "\nunit = \"kg\"\nsource = \"density times volume\"\nallowed = 1e-9\n";
}

class Verify : public SceneRuns {
 protected:
  void SetUp() override {
    SceneRuns::SetUp();
    write("beam.toml", kCantilever);
  }
  ProgramResult verify(std::vector<std::string> args, const ProgramOptions& options = {}) const {
    args.insert(args.begin(), {"verify", "--cases", "cases"});
    return fascia(args, options);
  }
  nlohmann::json report(const std::string& directory = "results/verify") const {
    return nlohmann::json::parse(read_text(folder_ / directory / "verify.json"));
  }
};

TEST_F(Verify, PassesAndWritesItsReport) {
  write("cases/a.toml", run_of("good", 40, "repeat = true\n"));
  const ProgramResult r = verify({"--jobs", "2"});
  EXPECT_EQ(r.status, 0) << r.err;
  EXPECT_NE(r.out.find("1 case of 1 run: 1 passed, 0 failed, 0 skipped"), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("2 of 2 repeated runs equal bit for bit"), std::string::npos) << r.out;
  const nlohmann::json j = report();
  EXPECT_EQ(j["status"], "passed");
  EXPECT_EQ(j["runs"][0]["cases"][0]["verdict"], "passed");
  EXPECT_NEAR(j["runs"][0]["cases"][0]["value"].get<double>(), 40, 1e-9);
  EXPECT_EQ(j["runs"][0]["repetitions"].size(), 2u);
  std::set<std::string> hashed;
  for (const auto& [file, digest] : j["certificate"]["program"]["sha256"].items()) {
    hashed.insert(std::filesystem::path(file).filename());
    EXPECT_EQ(digest.get<std::string>().size(), 64u);
  }
  EXPECT_TRUE(hashed.contains("fascia") && hashed.contains("libfascia.so"));
  for (const char* key : {"version", "commit", "compiler", "flags", "libraries"})
    EXPECT_TRUE(j["certificate"]["program"].contains(key)) << key;
  EXPECT_EQ(lines_of(read_text(folder_ / "results/verify/verify.csv")).size(), 2u);
  EXPECT_NE(read_text(folder_ / "results/verify/verify.html").find("A &lt;small&gt; beam"), std::string::npos);
  const std::string command = j["runs"][0]["command"];
  EXPECT_EQ(command.rfind("fascia run ", 0), 0u) << command;
  // Again, into the same directory, and only JSON.
  const ProgramResult again = verify({"good", "--json"});
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(nlohmann::json::parse(again.out)["status"], "passed");
  EXPECT_EQ(again.err, "");
}

TEST_F(Verify, SaysWhatFailedAndWhy) {
  write(
      "cases/a.toml",
      run_of("heavy", 41) +
          run_of("stuck", 40,
                 "set = [\"solver.newton.max_iterations=1\", \"world.gravity=[0,-9,0]\", \"solver.load_steps=1\"]\n") +
          run_of("good", 40) + run_of("meshless", 40, "set = ['bodies.beam.frames={file=\"gone.csv\"}']\n"));
  const ProgramResult r = verify({"--output", "out"});
  EXPECT_EQ(r.status, 3);
  EXPECT_NE(r.out.find("failed: heavy-mass: 40 kg; reference 41 kg, error -2.4 %, allowed 1e-07 %"), std::string::npos)
      << r.out;
  EXPECT_NE(r.out.find("failed: stuck-mass: the run ended as"), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("skipped: meshless-mass: gone.csv is missing"), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("1 passed, 2 failed, 1 skipped"), std::string::npos) << r.out;
  EXPECT_EQ(report("out")["status"], "failed");
  EXPECT_EQ(verify({"good", "--output", "out"}).status, 0);
}

TEST_F(Verify, RunsAScenesTextWithFilesBesideTheCaseFile) {
  write("cases/frames.csv", "x,y,z\n0,0,0\n0.5,0.1,0.1\n1,0,0\n1,0.2,0.2\n0,0.2,0.2\n0,0.2,0\n");
  const std::string scene = with(kCantilever, "frames   = { grid = [3, 2, 2] }",
                                 "frames = { file = \"frames.csv\" }\npoints = { count = 60 }");
  write("cases/a.toml", with(run_of("text", 40), "file = \"../beam.toml\"", "scene = '''\n" + scene + "'''"));
  const ProgramResult r = verify({"--output", "out"});
  EXPECT_EQ(r.status, 0) << r.out << r.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/scenes/text.toml"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/runs/text/summary.json"));
}

TEST_F(Verify, RefusesBadInput) {
  write("cases/a.toml", run_of("good", 40));
  const ProgramResult unknown = verify({"goud"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("\"goud\" is no run, case, topic or feature; did you mean \"good\"?"), std::string::npos)
      << unknown.err;
  const ProgramResult jobs = verify({"--jobs", "0"});
  EXPECT_EQ(jobs.status, 2);
  const ProgramResult partial = verify({"good", "--full", "--write-validation", "page.md"});
  EXPECT_EQ(partial.status, 2);
  EXPECT_NE(partial.err.find("needs every case"), std::string::npos) << partial.err;
  write("mine/notes.txt", "mine");
  const ProgramResult foreign = verify({"--output", "mine"});
  EXPECT_EQ(foreign.status, 4);
  EXPECT_NE(foreign.err.find("is no result of fascia verify"), std::string::npos) << foreign.err;
  EXPECT_EQ(read_text(folder_ / "mine/notes.txt"), "mine");
  write("mine/verify.json", "{}");
  EXPECT_EQ(verify({"--output", "mine"}).status, 4);
  write("cases/b.toml", "[[runs]\n");
  const ProgramResult damaged = verify({});
  EXPECT_EQ(damaged.status, 2);
  EXPECT_EQ(damaged.err.rfind("cases/b.toml:1:", 0), 0u) << damaged.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results"));
  EXPECT_EQ(fascia({"verify", "--cases", "nowhere"}).status, 4);
}

TEST_F(Verify, ListsWithoutRunning) {
  write("cases/a.toml", run_of("good", 40) + run_of("long", 40, "level = \"full\"\n"));
  const ProgramResult r = verify({"--list"});
  EXPECT_EQ(r.status, 0);
  EXPECT_NE(r.out.find("2 runs, 1 of them long, with 2 cases"), std::string::npos) << r.out;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results"));
}

TEST_F(Verify, InterruptedKeepsWhatWasDone) {
  write("cases/a.toml",
        run_of("good", 40) +
            run_of("endless", 40, "set = ['solver={kind=\"implicit-euler\",time_step=0.01,steps=100000000}']\n"));
  ProgramOptions options;
  options.signal = SIGINT;
  options.signal_after = std::chrono::milliseconds(700);
  const ProgramResult r = verify({"--jobs", "2", "--output", "out"}, options);
  EXPECT_EQ(r.status, 130) << r.err;
  const nlohmann::json j = report("out");
  EXPECT_EQ(j["status"], "interrupted");
  EXPECT_EQ(j["runs"][0]["cases"][0]["verdict"], "passed");
  EXPECT_EQ(j["runs"][1]["cases"][0]["verdict"], "skipped");
  EXPECT_NE(r.out.find("interrupted: 1 run not made"), std::string::npos) << r.out;
}

TEST_F(Verify, ARunEndsAtTheTimeLimit) {
  write("cases/a.toml",
        run_of("endless", 40, "set = ['solver={kind=\"implicit-euler\",time_step=0.01,steps=100000000}']\n"));
  const ProgramResult r = verify({"--time-limit", "0.2", "--output", "out"});
  EXPECT_EQ(r.status, 3);
  EXPECT_NE(r.out.find("did not end within 0.2 s"), std::string::npos) << r.out;
}

}  // namespace
}  // namespace fascia::verify_test
