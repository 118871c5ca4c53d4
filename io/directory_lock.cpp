#include "io/directory_lock.hpp"

#include "core/base/errors.hpp"
#include "io/files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <string>

namespace fascia::io {
namespace {

std::string host() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "this machine";
}

/// Who wrote the file: "PID HOST".
struct Holder {
  std::string pid, host;
};

Holder holder(int descriptor) {
  std::array<char, 512> text{};
  const ssize_t count = pread(descriptor, text.data(), text.size() - 1, 0);
  const std::string line(text.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
  const std::size_t space = line.find(' '), end = line.find('\n');
  if (space == std::string::npos || end == std::string::npos || space > end) return {};
  return {line.substr(0, space), line.substr(space + 1, end - space - 1)};
}

}  // namespace

/// False where the file was removed by its holder meanwhile.
bool DirectoryLock::open_file() {
  descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail_write(directory_, errno);
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    const bool held = errno == EWOULDBLOCK;
    const Holder other = holder(descriptor_);
    // Some file systems know no locks: there the process that is named tells.
    const int process = std::atoi(other.pid.c_str());
    const bool lives = process > 0 && process != getpid() && other.host == host() && kill(process, 0) == 0;
    if (held || lives)
      refuse(fmt::format("another run writes its result there{}; wait for its end, or choose another directory",
                         other.pid.empty() ? "" : fmt::format(" (process {} on {})", other.pid, other.host)));
  }
  struct stat opened {
  }, named{};
  const bool same = fstat(descriptor_, &opened) == 0 && stat(file_.c_str(), &named) == 0 &&
                    opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
  if (!same) close(descriptor_);
  return same;
}

DirectoryLock::DirectoryLock(const std::filesystem::path& directory) : directory_(directory), file_(directory / kName) {
  while (!open_file()) {
  }
  const Holder other = holder(descriptor_);
  if (!other.host.empty() && other.host != host())
    refuse(fmt::format("process {} on {} writes its result there, or died; where it did, remove {}", other.pid,
                       other.host, file_.string()));
  const std::string line = fmt::format("{} {}\n", getpid(), host());
  // A lock without its text (a full disk) holds as well; it says less.
  if (ftruncate(descriptor_, 0) == 0) [[maybe_unused]]
    const ssize_t written = pwrite(descriptor_, line.data(), line.size(), 0);
}

void DirectoryLock::refuse(const std::string& why) {
  close(descriptor_);
  throw FileError(fmt::format("{}: {}", directory_.string(), why));
}

DirectoryLock::~DirectoryLock() {
  unlink(file_.c_str());
  close(descriptor_);
}

}  // namespace fascia::io
