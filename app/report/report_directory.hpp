#pragma once

#include "io/directory_lock.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// The directory that a command fills with its report, NAME.json among it. It is held as long as this lives.
class ReportDirectory {
 public:
  /// Makes it; of an older report `parts` are removed.
  /// @param command  NAME, "verify"
  /// @throws FileError  it exists and holds no report of this command, cannot be made, or another process fills it
  ReportDirectory(std::filesystem::path path, const std::string& command, const std::vector<std::string>& parts);

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file of it. @throws FileError
  void write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
  std::optional<io::DirectoryLock> lock_;
};

}  // namespace fascia::app
