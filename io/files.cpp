#include "io/files.hpp"

#include "core/base/errors.hpp"

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <memory>
#include <system_error>

namespace fascia::io {
namespace {

namespace fs = std::filesystem;

std::string reason(int error) { return std::generic_category().message(error); }

/// Zero, or why the bytes could not be written; then nothing is left of them.
int write_whole(const fs::path& path, std::string_view bytes) {
  errno = 0;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"), &std::fclose);
  if (!file) return errno;
  int error = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) error = errno;
  if (std::fclose(file.release()) != 0 && error == 0) error = errno;
  std::error_code ignored;
  if (error != 0 && fs::is_regular_file(path, ignored)) fs::remove(path, ignored);
  return error;
}

}  // namespace

fs::path part_of(const fs::path& path) { return path.parent_path() / ("." + path.filename().string() + ".part"); }

void fail_write(const fs::path& path, int error) {
  std::string advice = "check the path and its permissions";
  if (error == ENOSPC || error == EDQUOT || error == EFBIG) advice = "free space there or write elsewhere";
  throw FileError(path.string() + ": cannot be written: " + reason(error) + "; " + advice);
}

void check_readable(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw FileError(path.string() + ": cannot be opened: it does not exist; check the path");
  if (fs::is_directory(status)) throw FileError(path.string() + ": is a directory; give a mesh file");
  if (!fs::is_regular_file(status)) throw FileError(path.string() + ": is no ordinary file; give a mesh file");
  errno = 0;
  if (!std::ifstream(path, std::ios::binary)) throw FileError(path.string() + ": cannot be opened: " + reason(errno));
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) throw FileError(path.string() + ": cannot be read: " + error.message());
  if (size == 0) throw InputError(path.string() + ": the file is empty; give a mesh");
  if (size > largest_file)
    throw InputError(path.string() + ": the file has " + std::to_string(size) + " bytes; must be at most 2 GiB");
}

std::string read_file(const fs::path& path) {
  check_readable(path);
  std::string text(fs::file_size(path), '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.gcount() != static_cast<std::streamsize>(text.size()))
    throw FileError(path.string() + ": could be read in part only; check the disk");
  return text;
}

void make_directories(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path, error))
    throw FileError(path.string() + ": cannot be made: " + (error ? error.message() : "a file of that name exists") +
                    "; check the path and its permissions");
}

void write_file(const fs::path& path, std::string_view bytes) {
  if (path.has_parent_path()) make_directories(path.parent_path());
  if (const int error = write_whole(path, bytes); error != 0) fail_write(path, error);
}

void replace_file(const fs::path& path, std::string_view bytes) {
  if (path.has_parent_path()) make_directories(path.parent_path());
  const fs::path part = part_of(path);
  if (const int error = write_whole(part, bytes); error != 0) fail_write(path, error);
  if (std::rename(part.c_str(), path.c_str()) == 0) return;
  const int error = errno;
  std::error_code ignored;
  fs::remove(part, ignored);
  fail_write(path, error);
}

}  // namespace fascia::io
