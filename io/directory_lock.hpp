#pragma once

#include <filesystem>

namespace fascia::io {

/// A file that says that this process writes into a directory, held as long as this object lives. The lock of a process
/// that died counts for nothing.
class DirectoryLock {
 public:
  /// @throws FileError  where the directory cannot be written, or another process that lives holds it, or one of
  /// another
  ///                    machine, of which this one cannot tell whether it lives
  explicit DirectoryLock(const std::filesystem::path& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

  static constexpr const char* kName = ".fascia.lock";

 private:
  bool open_file();
  [[noreturn]] void refuse(const std::string& why);

  std::filesystem::path directory_, file_;
  int descriptor_ = -1;
};

}  // namespace fascia::io
