#include "io/result_directory.hpp"

#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "io/picture_description.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <exception>
#include <fstream>
#include <system_error>

namespace fascia::io {
namespace {

namespace fs = std::filesystem;

/// Where an older result waits, inside of the directory.
constexpr const char* kOlder = ".fascia.older";
/// It moves here once the new one is shown, and only waits to be removed.
constexpr const char* kOutdated = ".fascia.outdated";
constexpr const char* kSummary = "summary.json";

bool there_is(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

/// The names of a result of this program in a directory, as its summary.json says.
std::optional<ResultNames> names_of_result(const fs::path& directory) {
  std::ifstream stream(directory / kSummary, std::ios::binary);
  if (!stream) return std::nullopt;
  nlohmann::json summary;
  try {
    summary = nlohmann::json::parse(stream, nullptr, false);
  } catch (const std::ios_base::failure&) {  // a directory of that name
    return std::nullopt;
  }
  if (!summary.is_object() || !summary.contains("fascia")) return std::nullopt;
  ResultNames names;
  if (summary.contains("scene") && summary["scene"].is_string())
    names.stem = fs::path(summary["scene"].get<std::string>()).stem().string();
  if (summary.contains("bodies") && summary["bodies"].is_object())
    for (const auto& [body, unused] : summary["bodies"].items()) names.bodies.push_back(body);
  return names;
}

/// BODY_00000.vtu, with five digits or more.
bool is_state_of(const std::string& file, const std::string& body) {
  const std::string_view end = ".vtu";
  if (!file.starts_with(body + "_") || !file.ends_with(end) || file.size() < body.size() + 1 + 5 + end.size())
    return false;
  const std::string_view number(file.data() + body.size() + 1, file.size() - body.size() - 1 - end.size());
  return std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool belongs(const std::string& file, const ResultNames& names) {
  if (file == kSummary || file == "probes.csv" || file == kDescriptionFile || file == kChosenScene ||
      file == names.stem + ".pvd" || file == names.stem + ".png")
    return true;
  return std::any_of(names.bodies.begin(), names.bodies.end(), [&](const std::string& body) {
    return is_state_of(file, body) || file == failed_state_file(body);
  });
}

/// Files of a directory that a result of these names would have, and those that it was writing; summary.json first.
std::vector<std::string> files_of(const fs::path& directory, const ResultNames& names) {
  std::vector<std::string> files;
  std::error_code error;
  for (fs::directory_iterator it(directory, error), end; !error && it != end; it.increment(error)) {
    const std::string file = it->path().filename().string();
    const bool part = file.size() > 6 && file.starts_with(".") && file.ends_with(".part");
    if (belongs(part ? file.substr(1, file.size() - 6) : file, names)) files.push_back(file);
  }
  std::sort(files.begin(), files.end(), [](const std::string& a, const std::string& b) {
    return std::make_pair(a != kSummary, a) < std::make_pair(b != kSummary, b);
  });
  return files;
}

/// summary.json, which says what belongs to it, goes first and comes last: without it nothing else is taken for a part.
void set_aside(const fs::path& directory, const ResultNames& names) {
  const fs::path older = directory / kOlder;
  make_directories(older);
  for (const std::string& file : files_of(directory, names)) {
    std::error_code error;
    fs::rename(directory / file, older / file, error);
    if (error) throw FileError((directory / file).string() + ": cannot be replaced: " + error.message());
  }
}

void remove_result(const fs::path& directory) {
  const std::optional<ResultNames> names = names_of_result(directory);
  if (!names) return;
  std::vector<std::string> files = files_of(directory, *names);
  std::error_code ignored;
  for (auto file = files.rbegin(); file != files.rend(); ++file) fs::remove(directory / *file, ignored);
}

/// Removes what there is of a new result, and puts the older one back. A summary.json is aside exactly as long as there
/// is an older result to put back.
void restore(const fs::path& directory) {
  const fs::path older = directory / kOlder;
  std::error_code ignored;
  if (there_is(older / kSummary)) remove_result(directory);
  std::vector<fs::path> files;
  for (fs::directory_iterator it(older, ignored), end; !ignored && it != end; it.increment(ignored))
    files.push_back(it->path());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return (a.filename() == kSummary) < (b.filename() == kSummary);
  });
  for (const fs::path& file : files) fs::rename(file, directory / file.filename(), ignored);
  fs::remove(older, ignored);
}

/// True of files that a process that was killed left, and that belong to nothing.
bool is_left_over(const std::string& file) {
  return file == part_of(kSummary).string() || file == kTwins || file.starts_with(kOutdated);
}

void remove_left_over(const fs::path& directory) {
  std::error_code ignored;
  std::vector<fs::path> files;
  for (fs::directory_iterator it(directory, ignored), end; !ignored && it != end; it.increment(ignored))
    if (is_left_over(it->path().filename().string())) files.push_back(it->path());
  for (const fs::path& file : files) fs::remove_all(file, ignored);
}

/// True where nothing but what this program keeps there for itself is in a directory.
bool holds_nothing(const fs::path& directory) {
  std::error_code error;
  for (fs::directory_iterator it(directory, error), end; !error && it != end; it.increment(error)) {
    const std::string file = it->path().filename().string();
    if (file != DirectoryLock::kName && !is_left_over(file)) return false;
  }
  if (error)
    throw FileError(directory.string() + ": cannot be read: " + error.message() +
                    "; remove it or choose another directory");
  return true;
}

/// Fails where a directory may not be filled.
void check_replaceable(const fs::path& target) {
  std::error_code ignored;
  if (!there_is(target)) return;
  const std::string remedy = "; remove it or choose another directory";
  if (!fs::is_directory(target, ignored)) throw FileError(target.string() + ": exists and is no directory" + remedy);
  if (!holds_nothing(target) && !there_is(target / kOlder) && !names_of_result(target))
    throw FileError(target.string() + ": exists and is no result of this program (it has no summary.json of one)" +
                    remedy);
}

/// The directory itself, with symbolic links followed and no trailing slash.
fs::path resolved(const fs::path& target) {
  if (target.empty()) throw FileError("the directory of the results has no name; give one, such as results/NAME");
  std::error_code error;
  fs::path path = fs::weakly_canonical(fs::absolute(target), error);
  if (error) throw FileError(target.string() + ": cannot be used: " + error.message());
  if (!path.has_filename()) path = path.parent_path();
  if (!path.has_filename())
    throw FileError(target.string() + ": is no directory that could be replaced; choose another");
  return path;
}

}  // namespace

ResultDirectory::ResultDirectory(const fs::path& target, const ResultNames& names) : target_(resolved(target)) {
  check_replaceable(target_);
  make_directories(target_.parent_path());
  std::error_code error;
  made_ = fs::create_directory(target_, error);
  if (error) fail_write(target_, error.value());
  try {
    lock_.emplace(target_);
    prepare(names);
  } catch (...) {
    if (lock_ && there_is(target_ / kOlder)) restore(target_);
    lock_.reset();
    if (made_) fs::remove(target_, error);
    throw;
  }
}

void ResultDirectory::prepare(const ResultNames& names) {
  remove_left_over(target_);
  if (there_is(target_ / kOlder)) restore(target_);  // of a process that was killed before it had anything to show
  check_replaceable(target_);                        // again: another run may have filled it meanwhile
  if (const std::optional<ResultNames> older = names_of_result(target_)) set_aside(target_, *older);
  const std::vector<std::string> foreign = files_of(target_, names);
  if (foreign.empty()) return;
  throw FileError((target_ / foreign.front()).string() +
                  ": would be overwritten and belongs to no result there; move it, or choose another directory");
}

void ResultDirectory::show() {
  if (shown_) return;
  if (there_is(target_ / kOlder)) {
    fs::path outdated;  // what could not be removed of another one may be there still
    for (int k = 0; outdated.empty() || there_is(outdated); ++k)
      outdated = target_ / (kOutdated + ("-" + std::to_string(k)));
    std::error_code error;
    fs::rename(target_ / kOlder, outdated, error);
    if (error) fail_write(outdated, error.value());
    fs::remove_all(outdated, error);  // what cannot be removed now goes with the next result
  }
  shown_ = true;
}

void ResultDirectory::keep() {
  if (!there_is(target_ / kOlder)) shown_ = true;
}

ResultDirectory::~ResultDirectory() { leave(); }

void ResultDirectory::leave() noexcept {
  if (!lock_) return;
  try {
    if (!shown_ && there_is(target_ / kOlder))
      restore(target_);
    else if (!shown_)
      remove_result(target_);
    lock_.reset();
    std::error_code ignored;
    if (!shown_ && made_) fs::remove(target_, ignored);
  } catch (const std::exception&) {  // no memory: the next run there sees to it
  }
}

}  // namespace fascia::io
