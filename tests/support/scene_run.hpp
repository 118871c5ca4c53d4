#pragma once

#include "tests/support/paths.hpp"
#include "tests/support/run_numbers.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace fascia::test {

/// One run of a scene of this project by the program, in a directory of its own that goes with this object.
class SceneRun : public RunNumbers {
 public:
  /// @param scene     name of a file under scenes/, without ".toml"
  /// @param settings  each becomes --set
  /// @param options   further options of the command line
  explicit SceneRun(const std::string& scene, const Settings& settings = {},
                    const std::vector<std::string>& options = {}) {
    const std::filesystem::path file = fascia::test::source_dir() / "scenes" / (scene + ".toml");
    std::vector<std::string> command{fascia::test::program(), "run", file.string(), "--json", "--output",
                                     directory().string()};
    for (const std::string& s : settings) command.insert(command.end(), {"--set", s});
    command.insert(command.end(), options.begin(), options.end());
    ProgramOptions how;
    how.directory = folder_.path;
    how.timeout = std::chrono::minutes(4);
    program_ = run_program(command, how);
    summary_ = nlohmann::json::parse(program_.out, nullptr, false);
    if (summary_.is_discarded()) summary_ = nlohmann::json::object();
    EXPECT_EQ(program_.status, 0) << scene << ": " << program_.err;
    ok_ = program_.status == 0 && summary_.contains("probes");
    table_ = read_table(directory() / "probes.csv");
  }
  SceneRun(const SceneRun&) = delete;
  SceneRun& operator=(const SceneRun&) = delete;

  std::filesystem::path directory() const { return folder_.path / "out"; }
  /// Bytes of a file among the results.
  std::string bytes(const std::string& name) const {
    std::ifstream file(directory() / name, std::ios::binary);
    EXPECT_TRUE(file) << name;
    return {std::istreambuf_iterator<char>(file), {}};
  }

  /// What `fascia compare` finds between the two results, files with fields among them; empty where all numbers are
  /// equal.
  std::string difference_to(const SceneRun& other) const {
    const ProgramResult compare = run_program(
        {fascia::test::program(), "compare", directory().string(), other.directory().string(), "--tolerance", "0"});
    return compare.status == 0 ? "" : compare.out + compare.err;
  }

 private:
  TemporaryFolder folder_;
  ProgramResult program_;
};

}  // namespace fascia::test
