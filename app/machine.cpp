#include "app/machine.hpp"

#include "app/version.hpp"
#include "core/base/processors.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <climits>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace fascia::app {
namespace {

/// What follows "KEY :" or "KEY:" in the first line of a file that begins so; empty where there is none.
std::string field_of(const std::filesystem::path& path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t colon = line.find(':');
    const std::size_t begin = colon == std::string::npos ? colon : line.find_first_not_of(" \t", colon + 1);
    if (begin != std::string::npos) return line.substr(begin);
  }
  return "";
}

std::string host_name() {
  std::array<char, HOST_NAME_MAX + 1> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

double total_memory() {
  std::istringstream text(field_of("/proc/meminfo", "MemTotal"));
  double kilobytes = 0;
  text >> kilobytes;
  return 1024 * kilobytes;
}

std::vector<std::string> gpus() {
  std::vector<std::string> models;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/driver/nvidia/gpus", none))
    models.push_back(field_of(entry.path() / "information", "Model"));
  return models;
}

/// The version within the driver's own words, the first number with two points or one: "580.65.06".
std::string driver_version() {
  std::istringstream text(field_of("/proc/driver/nvidia/version", "NVRM version"));
  for (std::string word; text >> word;)
    if (word.find_first_not_of("0123456789.") == std::string::npos && word.find('.') != std::string::npos) return word;
  return "";
}

/// "NAME VERSION, NAME VERSION" as pairs.
std::vector<std::pair<std::string, std::string>> pairs_of(const std::string& list) {
  std::vector<std::pair<std::string, std::string>> pairs;
  std::istringstream text(list);
  for (std::string name, version; text >> name >> version;) {
    if (version.ends_with(',')) version.pop_back();
    pairs.emplace_back(name, version);
  }
  return pairs;
}

}  // namespace

std::vector<std::string> files_of_program() {
  std::vector<std::string> files;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    const std::size_t begin = line.find('/');
    if (begin == std::string::npos) continue;
    const std::string path = line.substr(begin);
    const std::string name = std::filesystem::path(path).filename().string();
    const bool own = name.starts_with("fascia") || name.starts_with("libfascia");
    if (own && std::find(files.begin(), files.end(), path) == files.end()) files.push_back(path);
  }
  return files;
}

Machine this_machine() {
  Machine m;
  m.date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  utsname system{};
  if (uname(&system) == 0) m.system = fmt::format("{} {} {}", system.sysname, system.release, system.machine);
  m.cpu = field_of("/proc/cpuinfo", "model name");
  m.threads = available_processors();
  m.memory = total_memory();
  m.gpu = gpus();
  m.driver = driver_version();
  m.host = host_name();
  m.fascia = FASCIA_VERSION;
  m.commit = commit();
  m.backends = backends_so_far();
  m.compiler = fmt::format("{} {}", FASCIA_COMPILER, __VERSION__);
  m.flags = FASCIA_FLAGS;
  m.build = FASCIA_BUILD;
  m.libraries = pairs_of(FASCIA_LIBRARIES);
  return m;
}

}  // namespace fascia::app
