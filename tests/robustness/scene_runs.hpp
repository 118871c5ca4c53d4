#pragma once

#include "tests/support/paths.hpp"
#include "tests/support/run_program.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace fascia::test {

/// A small cantilever, clamped at x = 0, that sags by a few percent; solved in milliseconds.
inline constexpr const char* kCantilever = R"(title = "Small cantilever"

[world]
gravity = [0, -1, 0]

[materials.soft]
young   = "100 kPa"
poisson = 0.3

[bodies.beam]
model    = "meshless"
domain   = { box = { min = [0, 0, 0], max = [1, 0.2, 0.2] } }
density  = 1000
material = "soft"
frames   = { grid = [3, 2, 2] }

[[constraints]]
body  = "beam"
where = { box = { min = [-0.01, -1, -1], max = [0.01, 1, 1] } }
fix   = "all"

[solver]
kind = "static"

[probes.tip]
body = "beam"
at = [1, 0.1, 0.1]
quantity = "displacement"

[probes.weight]
body = "beam"
quantity = "mass"
)";

/// The same beam over ten time steps, saved every second one.
inline constexpr const char* kDynamics = "kind = \"implicit-euler\"\ntime_step = \"10 ms\"\nsteps = 10";

/// `text` with the one occurrence of `from` replaced; fails the test where there is not exactly one.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "nothing to replace: " << from;
  if (at == std::string::npos) return text;
  EXPECT_EQ(text.find(from, at + 1), std::string::npos) << "ambiguous: " << from;
  return text.replace(at, from.size(), to);
}

inline std::string dynamic_scene() {
  return with(kCantilever, "kind = \"static\"", kDynamics) + "[output]\nevery_steps = 2\n";
}

/// "LINE:COLUMN" of the one occurrence of `token`, counted from one.
inline std::string place_of(const std::string& text, const std::string& token) {
  const std::size_t at = text.find(token);
  EXPECT_NE(at, std::string::npos) << token;
  if (at == std::string::npos) return "";
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  const std::size_t line_start = text.rfind('\n', at);
  const std::size_t column = line_start == std::string::npos ? at + 1 : at - line_start;
  return std::to_string(line) + ":" + std::to_string(column);
}

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << "cannot read " << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

/// An empty folder for each test, gone at its end, in which the program is run.
class SceneRuns : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "fascia test XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  /// Runs the program in the test's folder.
  ProgramResult fascia(std::vector<std::string> args) const {
    ProgramOptions options;
    return fascia(std::move(args), options);
  }
  ProgramResult fascia(std::vector<std::string> args, ProgramOptions options) const {
    args.insert(args.begin(), fascia::test::program());
    options.directory = folder_;
    ProgramResult result = run_program(args, options);
    EXPECT_FALSE(result.timed_out) << result.err;
    return result;
  }

  /// @param blamed  what the message must say
  void expect_refused(const std::string& scene, const std::vector<std::string>& blamed) const {
    write("scene.toml", scene);
    for (const char* command : {"check", "run"}) {
      std::vector<std::string> arguments{command, "scene.toml"};
      if (command == std::string("run")) arguments.insert(arguments.end(), {"--output", "out"});
      const ProgramResult result = fascia(arguments);
      EXPECT_EQ(result.status, 2) << result.err;
      EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
      EXPECT_EQ(result.err.rfind("scene.toml:", 0), 0u) << result.err;
      for (const std::string& says : blamed)
        EXPECT_NE(result.err.find(says), std::string::npos) << "should say '" << says << "': " << result.err;
      EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
    }
  }

  nlohmann::json summary(const std::string& directory) const {
    return nlohmann::json::parse(read_text(folder_ / directory / "summary.json"));
  }

  /// Every file below the folder with its content (a directory: its name with a slash at the end).
  std::map<std::string, std::string> snapshot() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
      const std::string name = std::filesystem::relative(entry.path(), folder_).string();
      if (entry.is_directory()) {
        files[name + "/"] = "";
      } else {
        files[name] = read_text(entry.path());
      }
    }
    return files;
  }

  std::filesystem::path folder_;
};

}  // namespace fascia::test
