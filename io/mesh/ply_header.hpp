#pragma once

#include "io/mesh/text_lines.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// A PLY file says this of itself before its numbers begin.
namespace fascia::io {

enum class PlyKind { text, little_endian, big_endian };
/// A type of numbers of a binary file.
struct PlyType {
  std::size_t size = 0;                    ///< in bytes
  double (*value)(const char*) = nullptr;  ///< of a number whose bytes are in the order of this machine
};

struct PlyProperty {
  std::string name;
  PlyType type;
  std::optional<PlyType> length;  ///< of a list: the type of how many there are
};

/// Elements of one kind.
struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyKind kind = PlyKind::text;
  std::vector<PlyElement> elements;
};

/// Reads the lines up to end_header. @throws InputError  "NAME:LINE: what is wrong; remedy"
PlyHeader read_ply_header(TextLines& lines);

}  // namespace fascia::io
