// scenes/cases: the registry that `fascia verify` and docs/validation.md share.
#include "tests/support/cases.hpp"
#include "tests/support/scene_run.hpp"

namespace fascia::test::registry_test {
namespace {

TEST(Registry, EveryCaseHolds) {
  const TemporaryFolder folder;
  ProgramOptions options;
  options.directory = folder.path;
  options.timeout = std::chrono::minutes(20);
  std::vector<std::string> command{
      program(), "verify", "--json", "--jobs", "2", "--cases", (source_dir() / "scenes/cases").string()};
  if (full_size()) command.emplace_back("--full");
  const ProgramResult result = run_program(command, options);
  ASSERT_FALSE(result.timed_out);
  const nlohmann::json report = nlohmann::json::parse(result.out, nullptr, false);
  ASSERT_TRUE(report.is_object()) << result.err;
  std::size_t cases = 0;
  for (const nlohmann::json& run : report["runs"]) {
    for (const nlohmann::json& c : run["cases"]) {
      ++cases;
      EXPECT_NE(c["verdict"], "failed") << c["name"] << ": value " << c["value"] << ", reference " << c["reference"]
                                        << ", error " << c["error"] << ", allowed " << c["allowed"] << ": "
                                        << c["reason"] << '\n'
                                        << run["command"];
    }
    for (const nlohmann::json& again : run["repetitions"])
      EXPECT_TRUE(again["equal"].get<bool>())
          << run["name"] << " again on " << again["threads"] << " threads: " << again["difference"];
  }
  EXPECT_EQ(result.status, 0) << result.err;
  std::printf("%zu cases of %zu runs, %.1f s of processors\n", cases, report["runs"].size(),
              report["processor_seconds"].get<double>());
}

}  // namespace
}  // namespace fascia::test::registry_test
