#include "app/cache.hpp"

#include "app/machine.hpp"
#include "io/files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <vector>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// The oldest files go, until half of what may be there is left.
void drop_old(const fs::path& folder, std::uintmax_t most) {
  struct Kept {
    fs::file_time_type time;
    std::uintmax_t size = 0;
    fs::path path;
  };
  std::error_code gone;
  std::vector<Kept> files;
  std::uintmax_t all = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::uintmax_t size = entry.file_size(gone);
    if (gone) continue;
    files.push_back({entry.last_write_time(gone), size, entry.path()});
    all += size;
  }
  if (all <= most) return;
  std::sort(files.begin(), files.end(), [](const Kept& a, const Kept& b) { return a.time < b.time; });
  for (const Kept& file : files) {
    if (all <= most / 2) return;
    fs::remove(file.path, gone);
    all -= file.size;
  }
}

/// Adds modules beside those files, which only other processes may have loaded.
std::set<std::string> with_modules(const std::vector<std::string>& files) {
  std::set<std::string> all(files.begin(), files.end());
  std::error_code none;
  for (const std::string& file : files)
    for (const auto& entry : fs::directory_iterator(fs::path(file).parent_path(), none))
      if (entry.path().filename().string().starts_with("fascia-") && entry.path().extension() == ".so")
        all.insert(entry.path().string());
  return all;
}

}  // namespace

fs::path cache_folder() {
  const auto set = [](const char* name) { return std::getenv(name) && *std::getenv(name); };
  if (set("XDG_CACHE_HOME")) return fs::path(std::getenv("XDG_CACHE_HOME")) / "fascia";
  if (set("HOME")) return fs::path(std::getenv("HOME")) / ".cache/fascia";
  return {};
}

std::string stamp_of_program(std::string_view prefix) {
  std::set<std::string> files;
  if (prefix.empty()) files = with_modules(files_of_program());
  for (const std::string& file : files_of_program())
    if (fs::path(file).filename().string().starts_with(prefix)) files.insert(file);
  std::error_code failed;
  if (files.empty()) files.insert(fs::read_symlink("/proc/self/exe", failed).string());  // the library is in it
  std::string stamp;
  for (const std::string& file : files) {
    const auto size = fs::file_size(file, failed);
    if (failed) return "";
    const auto time = fs::last_write_time(file, failed);
    if (failed) return "";
    stamp += fmt::format("{} {} {}\n", file, size, time.time_since_epoch().count());
  }
  return stamp;
}

void keep_in_cache(const fs::path& file, std::string_view bytes, std::uintmax_t most) {
  io::make_directories(file.parent_path());
  const fs::path own = fmt::format("{}.{}", file.string(), getpid());
  io::write_file(own, std::string(bytes));
  fs::rename(own, file);
  drop_old(file.parent_path(), most);
}

}  // namespace fascia::app
