#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

/// Where a test finds what it needs. Nothing of it is compiled in: a test program is the same in every clone.
namespace fascia::test {

/// The folder of the build, in which this test program lies.
inline std::filesystem::path build_dir() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

/// The program under test: of the same build.
inline std::string program() { return (build_dir() / "fascia").string(); }

/// The checkout: as ctest says in FASCIA_SOURCE_DIR, else the one that this build was configured for.
inline const std::filesystem::path& source_dir() {
  static const std::filesystem::path found = [] {
    if (const char* said = std::getenv("FASCIA_SOURCE_DIR")) return std::filesystem::path(said);
    const std::string key = "CMAKE_HOME_DIRECTORY:INTERNAL=";
    std::ifstream cache(build_dir() / "CMakeCache.txt");
    for (std::string line; std::getline(cache, line);)
      if (line.starts_with(key)) return std::filesystem::path(line.substr(key.size()));
    return std::filesystem::current_path();
  }();
  return found;
}

/// Data that lies beside the checkout and is no part of it; tests that want it skip where it is absent.
inline std::filesystem::path shared_dir() { return source_dir().parent_path() / "shared"; }

}  // namespace fascia::test
