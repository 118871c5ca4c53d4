#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace fascia::io {

/// The largest mesh file that is read, in bytes.
inline constexpr std::uintmax_t largest_file = std::uintmax_t{2} << 30;

/// Fails unless the file can be opened and is of a size that is read.
/// @throws FileError   it cannot be opened, or is a directory
/// @throws InputError  it is empty or above `largest_file`
void check_readable(const std::filesystem::path& path);

/// The whole file. @throws as check_readable, and FileError where reading stops short
std::string read_file(const std::filesystem::path& path);

/// Writes a whole file, parent directories included.
/// @throws FileError  where it cannot be written in whole; what was written is removed
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// Writes a whole file so that it is the old one or the new one at any moment: through a hidden file beside it.
void replace_file(const std::filesystem::path& path, std::string_view bytes);

/// That hidden file.
std::filesystem::path part_of(const std::filesystem::path& path);

/// Says that a file cannot be written, why, and what helps. @throws FileError
[[noreturn]] void fail_write(const std::filesystem::path& path, int error);

/// Creates a directory and its parents. @throws FileError
void make_directories(const std::filesystem::path& path);

}  // namespace fascia::io
