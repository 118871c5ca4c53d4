#include "io/mesh/ply_header.hpp"

#include "io/mesh/text_numbers.hpp"

#include <array>
#include <cstring>
#include <utility>

namespace fascia::io {
namespace {

using Words = std::vector<std::string_view>;

PlyKind kind_at(const TextLines& lines) {
  const Words& words = lines.words();
  const std::string_view kind = words.size() > 1 ? words[1] : std::string_view();
  if (kind == "ascii") return PlyKind::text;
  if (kind == "binary_little_endian") return PlyKind::little_endian;
  if (kind == "binary_big_endian") return PlyKind::big_endian;
  lines.fail("expected a format, found " + lines.found(1) +
             "; must be ascii, binary_little_endian or binary_big_endian");
}

template <class T>
double value_of(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}
template <class T>
constexpr PlyType kType{sizeof(T), value_of<T>};

PlyType type_at(const TextLines& lines, std::size_t word) {
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> types{{{"char", kType<std::int8_t>},
                                                                        {"int8", kType<std::int8_t>},
                                                                        {"uchar", kType<std::uint8_t>},
                                                                        {"uint8", kType<std::uint8_t>},
                                                                        {"short", kType<std::int16_t>},
                                                                        {"int16", kType<std::int16_t>},
                                                                        {"ushort", kType<std::uint16_t>},
                                                                        {"uint16", kType<std::uint16_t>},
                                                                        {"int", kType<std::int32_t>},
                                                                        {"int32", kType<std::int32_t>},
                                                                        {"uint", kType<std::uint32_t>},
                                                                        {"uint32", kType<std::uint32_t>},
                                                                        {"float", kType<float>},
                                                                        {"float32", kType<float>},
                                                                        {"double", kType<double>},
                                                                        {"float64", kType<double>}}};
  for (const auto& [name, type] : types)
    if (word < lines.words().size() && lines.words()[word] == name) return type;
  lines.fail("expected a type of numbers, found " + lines.found(word) +
             "; must be float, double, int, uchar or the like");
}

PlyProperty property_at(const TextLines& lines) {
  const Words& words = lines.words();
  PlyProperty p;
  const bool list = words.size() > 1 && words[1] == "list";
  if (list) p.length = type_at(lines, 2);
  const std::size_t type = list ? 3 : 1;
  p.type = type_at(lines, type);
  if (words.size() <= type + 1)
    lines.fail("expected the name of a property, found the end of the line; write it there");
  p.name = words[type + 1];
  return p;
}

PlyElement element_at(const TextLines& lines) {
  const Words& words = lines.words();
  if (words.size() < 2) lines.fail("expected the name of an element, found the end of the line; write it there");
  PlyElement element;
  element.name = words[1];
  constexpr std::int64_t shortest = 1;  // a byte
  element.count = lines.count(2, element.name == "vertex" ? "vertices" : element.name + "s", shortest);
  return element;
}

}  // namespace

PlyHeader read_ply_header(TextLines& lines) {
  PlyHeader header;
  lines.next();
  if (lines.words().empty() || lines.words()[0] != "ply")
    lines.fail("is no PLY mesh: found " + lines.found(0) + "; must start with ply");
  while (true) {
    if (!lines.next()) lines.fail("the header has no end; it is cut off: write the file again");
    const std::string_view word = lines.words()[0];
    if (word == "end_header") return header;
    if (word == "format") {
      header.kind = kind_at(lines);
    } else if (word == "element") {
      header.elements.push_back(element_at(lines));
    } else if (word == "property") {
      if (header.elements.empty()) lines.fail("a property comes before the first element; write the file again");
      header.elements.back().properties.push_back(property_at(lines));
    } else if (word != "comment" && word != "obj_info") {
      lines.fail(quoted(word) + " is no line of a PLY header; write the file again");
    }
  }
}

}  // namespace fascia::io
