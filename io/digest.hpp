#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace fascia::io {

/// SHA-256 in 64 lower-case hexadecimal digits.
std::string sha256(std::string_view bytes);

/// The same of a file's bytes. @throws FileError  where it cannot be read
std::string sha256_of(const std::filesystem::path& file);

}  // namespace fascia::io
