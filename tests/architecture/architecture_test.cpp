#include "tests/support/paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace fascia::architecture_test {

// The rules of docs/architecture.md that a machine can check: who includes whom, what only one folder knows, file
// sizes.
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = fascia::test::source_dir();
constexpr std::size_t kMostLines = 400;

/// What each folder may include of the project, beside itself. The six in the middle of the star see only core.
const std::map<std::string, std::set<std::string>> kMayInclude = {
    {"core", {}},
    {"meshless", {"core"}},
    {"fem", {"core"}},
    {"shells", {"core"}},
    {"coupling", {"core"}},
    {"gpu", {"core"}},
    {"io", {"core"}},
    {"assembly", {"core", "meshless", "fem", "shells", "coupling"}},
    {"fascia", {"core", "assembly", "gpu"}},
    {"examples", {"fascia"}},
    {"app", {"core", "meshless", "fem", "shells", "coupling", "gpu", "io", "assembly", "fascia"}},
    {"tests", {"core", "meshless", "fem", "shells", "coupling", "gpu", "io", "assembly", "fascia", "app"}},
    {"bench", {"core", "meshless", "fem", "shells", "coupling", "gpu", "io", "assembly", "fascia", "app", "tests"}}};

/// Rooms of a folder from the ground up: each may include those before it, none after.
const std::map<std::string, std::vector<std::string>> kRooms = {
    {"core",
     {"base", "space", "math", "geometry", "physics", "structure", "body", "node", "step", "linear", "levels",
      "executor", "tangent", "solver", "run"}},
    {"assembly", {"specification", "simulation", "bodies", "actions", "build"}},
    {"gpu", {"space", "tiles", "elements", "blocks", "step", "system", "explicit", "run"}}};

/// Sources and headers of a room.
constexpr std::size_t kMostFiles = 33;

struct Include {
  std::string file;    ///< who, relative to the root
  int line = 0;        ///< where
  std::string target;  ///< what stands between the quotes or brackets
};

std::vector<std::string> lines_of(const fs::path& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file) << "cannot read " << path;
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

std::string first_folder(const std::string& path) { return path.substr(0, path.find('/')); }

bool is_source(const fs::path& path) {
  static const std::set<std::string> endings = {".cpp", ".hpp", ".cu", ".cuh"};
  return endings.contains(path.extension().string());
}

bool is_header(const std::string& file) { return file.ends_with(".hpp") || file.ends_with(".cuh"); }

/// Every source file of the project, relative to the root, in a fixed order.
std::vector<std::string> source_files() {
  std::vector<std::string> files;
  for (const auto& [folder, allowed] : kMayInclude) {
    if (!fs::is_directory(kRoot / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      if (is_source(entry.path())) files.push_back(fs::relative(entry.path(), kRoot).generic_string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<Include> includes_of(const std::string& file) {
  static const std::regex form(R"re(^\s*#\s*include\s*["<]([^">]+)[">].*)re");
  std::vector<Include> includes;
  int number = 0;
  for (const std::string& line : lines_of(kRoot / file)) {
    ++number;
    std::smatch match;
    if (std::regex_match(line, match, form)) includes.push_back({file, number, match[1]});
  }
  return includes;
}

std::string place(const Include& include) {
  return include.file + ":" + std::to_string(include.line) + " includes " + include.target;
}

/// Checks every include of every file of one folder, or of all.
template <class Rule>
void for_each_include(const Rule& rule) {
  for (const std::string& file : source_files()) {
    for (const Include& include : includes_of(file)) rule(first_folder(file), include);
  }
}

TEST(Architecture, SourcesAreFound) { EXPECT_GT(source_files().size(), 20u) << "below " << kRoot; }

TEST(Architecture, EveryFolderOfSourcesIsPartOfTheStar) {
  const std::set<std::string> others = {"build", "results"};
  for (const auto& entry : fs::directory_iterator(kRoot)) {
    const std::string folder = entry.path().filename().string();
    if (!entry.is_directory() || folder.starts_with(".") || others.contains(folder)) continue;
    for (const auto& file : fs::recursive_directory_iterator(entry.path())) {
      EXPECT_TRUE(!is_source(file.path()) || kMayInclude.contains(folder)) << file.path();
    }
  }
}

TEST(Architecture, DependenciesFormAStar) {
  for_each_include([](const std::string& folder, const Include& include) {
    const std::string target = first_folder(include.target);
    if (!kMayInclude.contains(target) || target == folder) return;
    EXPECT_TRUE(kMayInclude.at(folder).contains(target)) << place(include);
  });
}

/// The second folder of core/solver/newton.hpp; of core/newton.hpp none.
std::string room_of(const std::string& path) {
  const std::size_t first = path.find('/'), second = path.find('/', first + 1);
  return second == std::string::npos ? std::string() : path.substr(first + 1, second - first - 1);
}

TEST(Architecture, RoomsStandOnThoseBelow) {
  for (const auto& [folder, rooms] : kRooms) {
    const auto floor = [&rooms](const std::string& room) { return std::find(rooms.begin(), rooms.end(), room); };
    for (const std::string& file : source_files()) {
      if (first_folder(file) != folder) continue;
      const auto own = floor(room_of(file));
      EXPECT_TRUE(own != rooms.end()) << file << " is in no room of " << folder;
      for (const Include& include : includes_of(file)) {
        if (first_folder(include.target) != folder || room_of(include.target).empty()) continue;
        EXPECT_TRUE(floor(room_of(include.target)) <= own) << place(include);
      }
    }
  }
}

TEST(Architecture, RoomsHoldFewFiles) {
  std::map<std::string, std::size_t> files;
  for (const std::string& file : source_files())
    if (first_folder(file) != "tests") ++files[fs::path(file).parent_path().generic_string()];
  for (const auto& [room, count] : files) EXPECT_LE(count, kMostFiles) << room << ": make two of it";
}

TEST(Architecture, IncludesOfTheProjectArePathsFromItsRoot) {
  for_each_include([](const std::string&, const Include& include) {
    EXPECT_EQ(include.target.find(".."), std::string::npos) << place(include);
    if (!is_source(include.target)) return;
    const bool beside = fs::exists((kRoot / include.file).parent_path() / include.target);
    EXPECT_TRUE(!beside || fs::exists(kRoot / include.target)) << place(include);
  });
}

TEST(Architecture, OnlyIoKnowsVtk) {
  for_each_include([](const std::string& folder, const Include& include) {
    const bool vtk = include.target.starts_with("vtk") && include.target.ends_with(".h");
    EXPECT_TRUE(!vtk || folder == "io" || include.file.starts_with("tests/")) << place(include);
  });
}

TEST(Architecture, CoreKnowsNoFilesAndNoScenes) {
  const std::set<std::string> files = {"fstream", "filesystem", "cstdio", "stdio.h", "iostream"};
  for_each_include([&files](const std::string& folder, const Include& include) {
    if (folder != "core") return;
    const std::string library = first_folder(include.target);
    // The system tells in files of its own how much of its processors' time a process may take.
    if (include.file != "core/base/processors.cpp") EXPECT_FALSE(files.contains(include.target)) << place(include);
    EXPECT_FALSE(library == "toml++" || library == "nlohmann" || library == "CLI") << place(include);
    EXPECT_FALSE(include.target == "udunits2.h" || include.target.starts_with("vtk")) << place(include);
  });
}

TEST(Architecture, FilesFitInAHead) {
  for (const std::string& file : source_files()) {
    EXPECT_LE(lines_of(kRoot / file).size(), kMostLines) << file << ": split it in two";
  }
}

TEST(Architecture, HeadersAreGuarded) {
  for (const std::string& file : source_files()) {
    if (!is_header(file)) continue;
    const auto lines = lines_of(kRoot / file);
    EXPECT_TRUE(std::find(lines.begin(), lines.end(), "#pragma once") != lines.end()) << file;
  }
}

// A comment is read without the one before it, in an editor or a list: it starts with what it describes.
TEST(Architecture, CommentsOfHeadersNameWhatTheyDescribe) {
  const std::set<std::string> folders = {"core", "fascia"};
  const std::regex comment(R"re(^\s*///)re"), first(R"re(^\s*/// *(What|Of|The same)\b)re");
  const std::regex beside(R"re(///< *(What|Of|The same)\b)re");
  for (const std::string& file : source_files()) {
    if (!folders.contains(first_folder(file)) || !is_header(file)) continue;
    bool inside = false;
    int number = 0;
    for (const std::string& line : lines_of(kRoot / file)) {
      ++number;
      const bool fragment = (!inside && std::regex_search(line, first)) || std::regex_search(line, beside);
      EXPECT_FALSE(fragment) << file << ":" << number << ": " << line;
      inside = std::regex_search(line, comment);
    }
  }
}

TEST(Architecture, NothingIsLeftForLater) {
  // Spelled in two parts, so that this file does not find itself.
  const std::regex marks(std::string("\\b(TO") + "DO|FIX" + "ME|XX" + "X|HA" + "CK)\\b");
  for (const std::string& file : source_files()) {
    int number = 0;
    for (const std::string& line : lines_of(kRoot / file)) {
      ++number;
      EXPECT_FALSE(std::regex_search(line, marks)) << file << ":" << number << ": " << line;
    }
  }
}

}  // namespace

}  // namespace fascia::architecture_test
