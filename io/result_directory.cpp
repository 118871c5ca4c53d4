#include "core/model/errors.hpp"
#include "io/files.hpp"
#include "io/result_writer.hpp"

#include <nlohmann/json.hpp>

#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <fstream>
#include <optional>
#include <system_error>

namespace fascia::io {
namespace {

namespace fs = std::filesystem;

/// Hidden siblings of NAME: ".NAME.partial-PID" is being written, ".NAME.older-PID" is about to be replaced.
constexpr const char* partial = "partial";
constexpr const char* older = "older";

fs::path sibling(const fs::path& target, const char* role, long pid) {
  return target.parent_path() / ("." + target.filename().string() + "." + role + "-" + std::to_string(pid));
}

/// The process that a hidden sibling of that role belongs to.
std::optional<long> owner(const fs::path& entry, const fs::path& target, const char* role) {
  const std::string name = entry.filename().string();
  const std::string prefix = "." + target.filename().string() + "." + role + "-";
  if (name.size() <= prefix.size() || name.compare(0, prefix.size(), prefix) != 0) return std::nullopt;
  long pid = 0;
  const auto [end, error] = std::from_chars(name.data() + prefix.size(), name.data() + name.size(), pid);
  if (error != std::errc{} || end != name.data() + name.size() || pid <= 0) return std::nullopt;
  return pid;
}

bool alive(long pid) { return kill(static_cast<pid_t>(pid), 0) == 0 || errno != ESRCH; }

bool is_result(const fs::path& directory) {
  std::ifstream stream(directory / "summary.json", std::ios::binary);
  if (!stream) return false;
  const nlohmann::json summary = nlohmann::json::parse(stream, nullptr, false);
  return summary.is_object() && summary.contains("fascia");
}

/// Fails where `target` exists and may not be replaced.
void check_replaceable(const fs::path& target) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(target, error);
  if (!fs::exists(status)) return;
  const std::string remedy = "; remove it or choose another directory";
  if (!fs::is_directory(status)) throw FileError(target.string() + ": exists and is no directory" + remedy);
  const bool empty = fs::is_empty(target, error);
  if (error) throw FileError(target.string() + ": cannot be read: " + error.message() + remedy);
  if (!empty && !is_result(target))
    throw FileError(target.string() + ": exists and is no result of this program (it has no summary.json of one)" +
                    remedy);
}

/// Removes what processes that were killed left, and puts back the older result of one killed between its two renames.
void clean_up(const fs::path& target) {
  std::error_code error;
  std::vector<fs::path> entries;
  for (fs::directory_iterator it(target.parent_path(), error), end; !error && it != end; it.increment(error))
    entries.push_back(it->path());
  for (const fs::path& entry : entries)
    for (const char* role : {older, partial}) {
      const std::optional<long> pid = owner(entry, target, role);
      if (!pid || (alive(*pid) && *pid != getpid())) continue;
      std::error_code ignored;
      if (role == older && !fs::exists(target, ignored))
        fs::rename(entry, target, ignored);
      else
        fs::remove_all(entry, ignored);
    }
}

/// The directory itself, with symbolic links followed and no trailing slash.
fs::path resolved(const fs::path& target) {
  std::error_code error;
  fs::path path = fs::weakly_canonical(fs::absolute(target), error);
  if (error) throw FileError(target.string() + ": cannot be used: " + error.message());
  if (!path.has_filename()) path = path.parent_path();
  if (!path.has_filename())
    throw FileError(target.string() + ": is no directory that could be replaced; choose another");
  return path;
}

}  // namespace

ResultDirectory::ResultDirectory(const fs::path& target) : target_(resolved(target)) {
  check_replaceable(target_);
  make_directories(target_.parent_path());
  clean_up(target_);
  work_ = sibling(target_, partial, getpid());
  make_directories(work_);
}

ResultDirectory::~ResultDirectory() {
  std::error_code ignored;
  if (!done_) fs::remove_all(work_, ignored);
}

void ResultDirectory::commit() {
  check_replaceable(target_);
  const fs::path aside = sibling(target_, older, getpid());
  std::error_code error;
  const bool replaces = fs::exists(target_, error);
  if (replaces) fs::rename(target_, aside, error);
  if (error) throw FileError(target_.string() + ": cannot be replaced: " + error.message() + "; it is as it was");
  fs::rename(work_, target_, error);
  if (error) {
    std::error_code restore;
    if (replaces) fs::rename(aside, target_, restore);
    throw FileError(target_.string() + ": cannot be written: " + error.message() + "; " +
                    (!replaces ? "nothing was written"
                     : restore ? "the older result is in " + aside.string()
                               : "the older result is as it was"));
  }
  done_ = true;
  fs::remove_all(aside, error);  // what cannot be removed now goes with the next result
}

}  // namespace fascia::io
