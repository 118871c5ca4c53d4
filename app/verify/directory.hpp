#pragma once

#include "io/directory_lock.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace fascia::app {

/// The directory that a verification fills: verify.json, verify.csv, verify.html, runs/NAME of each run, and scenes/ of
/// those whose text stands in a case file. It is held as long as this lives.
class VerifyDirectory {
 public:
  /// Makes it; of an older verification the runs are removed.
  /// @throws FileError  it exists and is no result of `fascia verify`, cannot be made, or another process fills it
  explicit VerifyDirectory(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path run(const std::string& name) const { return path_ / "runs" / name; }
  std::filesystem::path scene(const std::string& name) const { return path_ / "scenes" / (name + ".toml"); }
  /// Writes a file of it. @throws FileError
  void write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
  std::optional<io::DirectoryLock> lock_;
};

}  // namespace fascia::app
