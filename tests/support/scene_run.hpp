#pragma once

#include "tests/support/paths.hpp"
#include "tests/support/run_program.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace fascia::test {

/// "key.path=value", as after --set.
using Settings = std::vector<std::string>;

/// A new empty folder that goes with this object.
struct TemporaryFolder {
  std::filesystem::path path;
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "fascia_verification_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a directory for results");
    path = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
};

/// One run of a scene of this project by the program, in a directory of its own that goes with this object.
class SceneRun {
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
  }
  SceneRun(const SceneRun&) = delete;
  SceneRun& operator=(const SceneRun&) = delete;

  bool ok() const { return program_.status == 0 && summary_.contains("probes"); }
  const nlohmann::json& summary() const { return summary_; }
  std::filesystem::path directory() const { return folder_.path / "out"; }
  int newton_iterations() const { return summary_.value("newton_iterations", -1); }

  /// Value of a probe as JSON; null, with a failure, where there is none.
  nlohmann::json probe(const std::string& name) const {
    if (ok() && summary_["probes"].contains(name)) return summary_["probes"][name]["value"];
    ADD_FAILURE() << "no probe " << name;
    return nullptr;
  }
  /// NaN where the probe is missing, so that every comparison fails.
  double number(const std::string& name) const { return as_number(probe(name)); }
  std::array<double, 3> vector(const std::string& name) const { return as_vector(probe(name)); }
  std::vector<std::array<double, 3>> vectors(const std::string& name) const {
    std::vector<std::array<double, 3>> all;
    for (const nlohmann::json& v : probe(name)) all.push_back(as_vector(v));
    return all;
  }
  /// Rows of probes.csv as numbers, without the header; the first column is the time.
  std::vector<std::vector<double>> history() const {
    std::vector<std::vector<double>> rows;
    std::ifstream file(directory() / "probes.csv");
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
      std::vector<double> row;
      for (std::size_t begin = 0; begin <= line.size();) {
        const std::size_t end = std::min(line.find(',', begin), line.size());
        row.push_back(std::stod(line.substr(begin, end - begin)));
        begin = end + 1;
      }
      rows.push_back(std::move(row));
    }
    return rows;
  }
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

  static double as_number(const nlohmann::json& v) {
    return v.is_number() ? v.get<double>() : std::numeric_limits<double>::quiet_NaN();
  }
  static std::array<double, 3> as_vector(const nlohmann::json& v) {
    if (!v.is_array() || v.size() != 3) return {as_number(nullptr), as_number(nullptr), as_number(nullptr)};
    return {as_number(v[0]), as_number(v[1]), as_number(v[2])};
  }

 private:
  TemporaryFolder folder_;
  ProgramResult program_;
  nlohmann::json summary_;
};

/// "bodies.beam.frames.grid=[9,3,3]".
inline std::string grid_setting(const std::string& body, const std::array<int, 3>& grid) {
  return "bodies." + body + ".frames.grid=[" + std::to_string(grid[0]) + "," + std::to_string(grid[1]) + "," +
         std::to_string(grid[2]) + "]";
}

}  // namespace fascia::test
