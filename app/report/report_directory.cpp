#include "app/report/report_directory.hpp"

#include "core/base/errors.hpp"
#include "io/files.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// Empty, or filled by the same command.
bool is_free(const fs::path& path, const std::string& proof) {
  std::error_code none;
  if (!fs::exists(path, none)) return true;
  if (!fs::is_directory(path, none)) return false;
  std::ifstream file(path / proof);
  if (!file) {
    for (const fs::directory_entry& entry : fs::directory_iterator(path, none))
      if (entry.path().filename() != io::DirectoryLock::kName) return false;
    return !none;
  }
  const auto older = nlohmann::json::parse(file, nullptr, false);
  return older.is_object() && older.contains("fascia");
}

}  // namespace

ReportDirectory::ReportDirectory(fs::path path, const std::string& command, const std::vector<std::string>& parts)
    : path_(std::move(path)) {
  if (!is_free(path_, command + ".json"))
    throw FileError(
        fmt::format("{0}: exists and is no result of fascia {1} (it has no {1}.json of one); remove it "
                    "or choose another --output",
                    path_.string(), command));
  io::make_directories(path_);
  lock_.emplace(path_);
  for (const std::string& part : parts) fs::remove_all(path_ / part);
}

void ReportDirectory::write(const std::string& name, const std::string& text) const {
  io::replace_file(path_ / name, text);
}

}  // namespace fascia::app
