#include "app/run/process_memory.hpp"

#include "core/base/errors.hpp"

#include <fmt/format.h>
#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

constexpr double kNone = std::numeric_limits<double>::infinity();

/// Room that a process needs beside what it has when main() begins: stacks and heaps of threads, and a small scene.
constexpr double kLeastRoom = 96e6;

/// The number behind a key in a file of lines "key value", in the unit that stands there.
std::optional<double> number_behind(const fs::path& file, std::string_view key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string name;
    double value = 0;
    if (words >> name >> value && name == key) return value;
  }
  return std::nullopt;
}

/// A file that holds a number, or a word for none.
std::optional<double> number_in(const fs::path& file) {
  std::ifstream in(file);
  double value = 0;
  if (in >> value) return value;
  return std::nullopt;
}

double of_process(std::string_view key) { return 1024 * number_behind("/proc/self/status", key).value_or(0); }

/// One group leaves this: files that are cached and not in use can be dropped, and do not count.
double left_by_group(const fs::path& group, const char* limit, const char* used, const char* cached) {
  const std::optional<double> most = number_in(group / limit), taken = number_in(group / used);
  if (!most || !taken) return kNone;
  return std::max(0.0, *most - std::max(0.0, *taken - number_behind(group / "memory.stat", cached).value_or(0)));
}

/// The least that a group and those around it leave.
double left_by_groups(const fs::path& root, fs::path group, const char* limit, const char* used, const char* cached) {
  double left = left_by_group(root, limit, used, cached);
  for (group = group.relative_path(); !group.empty(); group = group.parent_path())
    left = std::min(left, left_by_group(root / group, limit, used, cached));
  return left;
}

/// One of the process' limits leaves this.
double left_by_limit(__rlimit_resource limit, double used) {
  rlimit most{};
  if (getrlimit(limit, &most) != 0 || most.rlim_cur == RLIM_INFINITY) return kNone;
  return std::max(0.0, static_cast<double>(most.rlim_cur) - used);
}

}  // namespace

void keep_freed_memory() {
  constexpr std::size_t block = 4U << 20U;
  void* volatile mapped = std::malloc(block);
  std::free(mapped);
}

double resident_memory() {
  malloc_trim(0);
  const std::optional<double> exact = number_behind("/proc/self/smaps_rollup", "Rss:");
  return exact ? 1024 * *exact : of_process("VmRSS:");
}

double peak_memory() {
  if (const double peak = of_process("VmHWM:"); peak > 0) return peak;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

double memory_left_by_groups(const fs::path& groups, const fs::path& root) {
  double left = kNone;
  std::ifstream in(groups);
  for (std::string line; std::getline(in, line);) {  // "number:controllers:path"
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const fs::path path = line.substr(second + 1);
    if (controllers == ",,")
      left = std::min(left, left_by_groups(root, path, "memory.max", "memory.current", "inactive_file"));
    else if (controllers.find(",memory,") != std::string::npos)
      left = std::min(left, left_by_groups(root / "memory", path, "memory.limit_in_bytes", "memory.usage_in_bytes",
                                           "total_inactive_file"));
  }
  return left;
}

FreeMemory free_memory() {
  FreeMemory free{1024 * number_behind("/proc/meminfo", "MemAvailable:").value_or(kNone), ""};
  const auto limit = [&](double left, const char* name) {
    if (left < free.bytes) free = {left, name};
  };
  limit(memory_left_by_groups("/proc/self/cgroup", "/sys/fs/cgroup"), " in the control group of the process");
  limit(left_by_limit(RLIMIT_AS, of_process("VmSize:")), " within the limit of the process (ulimit -v)");
  limit(left_by_limit(RLIMIT_DATA, of_process("VmData:")), " within the limit of the process (ulimit -d)");
  return free;
}

void require_room() {
  const auto check = [](__rlimit_resource limit, const char* key, const char* option) {
    const double used = of_process(key), left = left_by_limit(limit, used);
    if (left >= kLeastRoom) return;
    throw InputError(
        fmt::format("fascia: the limit of the process, ulimit {} {:.0f}, is {:.0f} MB, of which {:.0f} MB are taken "
                    "before a scene is read; a small scene needs {:.0f} MB: raise the limit to {:.0f} at least",
                    option, (used + left) / 1024, (used + left) / 1e6, used / 1e6, (used + kLeastRoom) / 1e6,
                    (used + kLeastRoom) / 1024));
  };
  check(RLIMIT_AS, "VmSize:", "-v");
  check(RLIMIT_DATA, "VmData:", "-d");
}

}  // namespace fascia::app
