#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace fascia::io {

/// A text file that grows by whole pieces and is complete at any moment: what ends it, if anything, is written anew
/// after each piece.
class GrowingFile {
 public:
  /// Writes the beginning, and the end. @throws FileError
  GrowingFile(std::filesystem::path path, std::string_view beginning, std::string end = "");
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  /// @throws FileError  where the piece cannot be written in whole; the file is then as it was before
  void append(std::string_view piece);
  /// Waits until what was written is on the disk.
  void synchronise() const;

 private:
  std::filesystem::path path_;
  std::string end_;
  int descriptor_ = -1;
  off_t size_ = 0;  ///< without the end
};

}  // namespace fascia::io
