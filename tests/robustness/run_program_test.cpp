#include "tests/support/run_program.hpp"

#include <gtest/gtest.h>

#include <csignal>

namespace fascia::run_program_test {

namespace {

using fascia::test::lines_of;
using fascia::test::ProgramOptions;
using fascia::test::ProgramResult;
using fascia::test::run_program;

TEST(RunProgram, SeparatesOutputsAndReturnsTheStatus) {
  const ProgramResult result = run_program({"sh", "-c", "echo one; echo two >&2; exit 7"});
  EXPECT_EQ(result.status, 7);
  EXPECT_EQ(result.out, "one\n");
  EXPECT_EQ(result.err, "two\n");
  EXPECT_FALSE(result.timed_out);
}

TEST(RunProgram, HandsArgumentsOverUnchanged) {
  const ProgramResult result = run_program({"printf", "%s|", "a b", "*", "$HOME", ""});
  EXPECT_EQ(result.out, "a b|*|$HOME||");
}

TEST(RunProgram, CollectsMoreThanAPipeHolds) {
  const ProgramResult result = run_program({"sh", "-c", "yes | head -c 1000000; yes | head -c 300000 >&2"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out.size(), 1'000'000u);
  EXPECT_EQ(result.err.size(), 300'000u);
}

TEST(RunProgram, UsesDirectoryAndEnvironment) {
  ProgramOptions options;
  options.directory = "/usr";
  options.environment = {"HOME=/elsewhere"};
  EXPECT_EQ(run_program({"sh", "-c", "pwd; echo $HOME"}, options).out, "/usr\n/elsewhere\n");
}

TEST(RunProgram, GivesNoStandardInput) { EXPECT_EQ(run_program({"cat"}).out, ""); }

TEST(RunProgram, SendsASignalAndReportsIt) {
  ProgramOptions options;
  options.signal = SIGINT;
  options.signal_after = std::chrono::milliseconds(200);
  EXPECT_EQ(run_program({"sleep", "20"}, options).status, 128 + SIGINT);
  EXPECT_EQ(run_program({"sh", "-c", "trap 'exit 5' INT; while :; do sleep 0.05; done"}, options).status, 5);
}

TEST(RunProgram, KillsAtTheTimeLimit) {
  ProgramOptions options;
  options.timeout = std::chrono::milliseconds(200);
  const ProgramResult result = run_program({"sleep", "20"}, options);
  EXPECT_TRUE(result.timed_out);
  EXPECT_EQ(result.status, 128 + SIGKILL);
}

TEST(RunProgram, SaysWhatCannotBeStarted) { EXPECT_THROW(run_program({"/no/such/program"}), std::runtime_error); }

TEST(LinesOf, KeepsEmptyLinesWithinATextOnly) {
  EXPECT_EQ(lines_of("a\n\nb\n"), (std::vector<std::string>{"a", "", "b"}));
  EXPECT_EQ(lines_of("a"), (std::vector<std::string>{"a"}));
  EXPECT_TRUE(lines_of("").empty());
}

}  // namespace

}  // namespace fascia::run_program_test
