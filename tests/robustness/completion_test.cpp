#include "tests/robustness/scene_runs.hpp"

namespace fascia::test::completion_test {
namespace {

/// Asks bash what it offers where the cursor stands at the end of a line.
class Completion : public SceneRuns {
 protected:
  void SetUp() override {
    SceneRuns::SetUp();
    write("organs.toml",
          "[materials.soft]\nyoung = 1\n[bodies.liver]\n[bodies.\"left "
          "kidney\"]\n[bodies.\"$(touch${IFS}pwned)\"]\n[bodies.liver.domain]\n"
          "[[loads]]\n[[loads]]\n");
    write("notes.txt", "");
  }
  std::vector<std::string> offered(const std::string& line) const {
    ProgramOptions options;
    options.directory = folder_;
    options.environment = {"PROGRAM=" + program(), "COMP_LINE=" + line};
    const ProgramResult r = run_program({"bash", "-c",
                                         "source <(\"$PROGRAM\" completion bash); COMP_POINT=${#COMP_LINE}; _fascia; "
                                         "printf '%s\\n' \"${COMPREPLY[@]}\""},
                                        options);
    EXPECT_EQ(r.err, "");
    return lines_of(r.out);
  }
  static bool has(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  }
};

TEST_F(Completion, CommandsOptionsAndScenes) {
  EXPECT_EQ(offered("fascia "), (std::vector<std::string>{"run", "check", "rerun", "compare", "study", "tune", "verify",
                                                          "explain", "extremes", "bench", "list", "completion",
                                                          "--help", "--version", "organs.toml"}));
  EXPECT_EQ(offered("fascia run o"), std::vector<std::string>{"organs.toml"});
  EXPECT_EQ(offered("fascia run --ver"), std::vector<std::string>{"--verbose"});
  EXPECT_EQ(offered("fascia run organs.toml --backend c"), (std::vector<std::string>{"cpu", "cuda"}));
  EXPECT_EQ(offered("fascia list "), (std::vector<std::string>{"--help", "scenes", "quantities", "units"}));
  EXPECT_EQ(offered("fascia bench table"), (std::vector<std::string>{"table2", "table3"}));
}

TEST_F(Completion, KeysWithTheNamesOfTheSceneOnTheLine) {
  const auto bodies = offered("fascia run organs.toml --set bodies.");
  EXPECT_TRUE(has(bodies, "bodies.liver.density="));
  EXPECT_FALSE(has(bodies, "bodies.*.density="));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "pwned")) << "a name of the scene was run as a command";
  EXPECT_EQ(offered("fascia check organs.toml --set materials.soft.yo"),
            std::vector<std::string>{"materials.soft.young="});
  const auto loads = offered("fascia run organs.toml --set loads.");
  EXPECT_TRUE(has(loads, "loads.1.profile="));
  EXPECT_FALSE(has(loads, "loads.2.profile="));
  EXPECT_TRUE(has(offered("fascia run --set solver."), "solver.kind=")) << "without a scene";
}

TEST_F(Completion, ValuesOfAKey) {
  EXPECT_EQ(offered("fascia run organs.toml --set solver.control=arc"), std::vector<std::string>{"arc-length"});
  EXPECT_TRUE(has(offered("fascia run organs.toml --set bodies.liver.model=s"), "shell"));
}

TEST_F(Completion, AnotherShellIsRefused) {
  const ProgramResult r = fascia({"completion", "fish"});
  EXPECT_EQ(r.status, 2);
  EXPECT_NE(r.err.find("bash"), std::string::npos) << r.err;
}

}  // namespace
}  // namespace fascia::test::completion_test
