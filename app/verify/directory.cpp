#include "app/verify/directory.hpp"

#include "core/model/errors.hpp"
#include "io/files.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// Empty, or filled by an older verification.
bool is_free(const fs::path& path) {
  std::error_code none;
  if (!fs::exists(path, none)) return true;
  if (!fs::is_directory(path, none)) return false;
  std::ifstream file(path / "verify.json");
  if (!file) {
    for (const fs::directory_entry& entry : fs::directory_iterator(path, none))
      if (entry.path().filename() != io::DirectoryLock::kName) return false;
    return !none;
  }
  const auto older = nlohmann::json::parse(file, nullptr, false);
  return older.is_object() && older.contains("fascia") && older.contains("certificate");
}

}  // namespace

VerifyDirectory::VerifyDirectory(fs::path path) : path_(std::move(path)) {
  if (!is_free(path_))
    throw FileError(
        fmt::format("{}: exists and is no result of fascia verify (it has no verify.json of one); remove it "
                    "or choose another --output",
                    path_.string()));
  io::make_directories(path_);
  lock_.emplace(path_);
  for (const char* part : {"runs", "scenes", "verify.html", "verify.csv"}) fs::remove_all(path_ / part);
}

void VerifyDirectory::write(const std::string& name, const std::string& text) const {
  io::replace_file(path_ / name, text);
}

}  // namespace fascia::app
