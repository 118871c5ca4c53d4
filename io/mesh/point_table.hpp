#pragma once

#include "core/math/vec3.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::io {

/// Frames or integration points that a user lists, in the order of the file.
struct PointTable {
  std::vector<Vec3d> position;  ///< (n) [m], n > 0
  std::vector<Vec3d> rotation;  ///< rotation vectors [rad]: none or n
  std::vector<double> volume;   ///< [m³], above 0: none or n
};

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
