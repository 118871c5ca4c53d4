#pragma once

#include "core/base/errors.hpp"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace fascia::app {

/// A folder of its own, which goes with this.
class TemporaryFolder {
 public:
  /// @throws FileError  it cannot be made
  explicit TemporaryFolder(const std::string& name) {
    std::string made = (std::filesystem::temp_directory_path() / (name + "-XXXXXX")).string();
    if (mkdtemp(made.data()) == nullptr) throw FileError(made + ": cannot be made; set TMPDIR to another directory");
    path_ = made;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace fascia::app
