#include "io/growing_file.hpp"

#include "io/files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace fascia::io {
namespace {

/// Zero, or why not all was written.
int write_at(int descriptor, std::string_view text, off_t place) {
  while (!text.empty()) {
    const ssize_t count = pwrite(descriptor, text.data(), text.size(), place);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count < 0 ? errno : ENOSPC;
    text.remove_prefix(static_cast<std::size_t>(count));
    place += count;
  }
  return 0;
}

}  // namespace

GrowingFile::GrowingFile(std::filesystem::path path, std::string_view beginning, std::string end)
    : path_(std::move(path)), end_(std::move(end)) {
  descriptor_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail_write(path_, errno);
  try {
    append(beginning);
  } catch (...) {
    close(descriptor_);
    unlink(path_.c_str());
    throw;
  }
}

GrowingFile::~GrowingFile() { close(descriptor_); }

void GrowingFile::append(std::string_view piece) {
  const int error = write_at(descriptor_, std::string(piece) + end_, size_);
  if (error == 0) {
    size_ += static_cast<off_t>(piece.size());
    return;
  }
  // The old end fits where it was, as long as nothing there is given back to the disk.
  const bool restored =
      write_at(descriptor_, end_, size_) == 0 && ftruncate(descriptor_, size_ + static_cast<off_t>(end_.size())) == 0;
  static_cast<void>(restored);
  fail_write(path_, error);
}

void GrowingFile::synchronise() const { fdatasync(descriptor_); }

}  // namespace fascia::io
