#pragma once

#include "core/geometry/point_table.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace fascia::io {

/// Reads comma-separated values in SI units.
///
/// The first line names the columns, in any order: x, y, z; perhaps rx, ry, rz; perhaps volume. A file without that
/// line holds x, y, z or x, y, z, rx, ry, rz. Blank lines, and what follows a #, do not count.
///
/// @throws FileError   it cannot be read
/// @throws InputError  its content is wrong; the message names file, line and column
PointTable read_point_table(const std::filesystem::path& path);

/// The same for a text. @param name  of the file, for messages
PointTable parse_point_table(std::string_view text, const std::string& name);

}  // namespace fascia::io
