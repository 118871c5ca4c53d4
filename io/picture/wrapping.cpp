#include "io/picture/wrapping.hpp"

#include <sstream>

namespace fascia::io {
namespace {

/// The text without its last character, which may be of several bytes.
void drop_last(std::string& text) {
  while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0U) == 0x80U) text.pop_back();
  if (!text.empty()) text.pop_back();
}

std::string shortened(std::string text, const TextWidth& width_of, double width) {
  if (width_of(text) <= width) return text;
  while (!text.empty() && width_of(text + "...") > width) drop_last(text);
  return text + "...";
}

}  // namespace

std::vector<std::string> wrapped(const std::string& text, const TextWidth& width_of, double width, std::size_t most) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.empty() ? word : lines.back() + " " + word;
    const bool joins = !lines.empty() && (lines.size() == most || width_of(longer) <= width);
    if (joins)
      lines.back() = longer;
    else
      lines.push_back(word);
  }
  for (std::string& line : lines) line = shortened(line, width_of, width);
  return lines;
}

std::vector<std::string> wrapped_with_unit(const std::string& words, const std::string& unit, const TextWidth& width_of,
                                           double width, std::size_t most) {
  std::vector<std::string> lines = wrapped(words, width_of, width, most);
  if (unit.empty()) return lines;
  if (!lines.empty() && width_of(lines.back() + " " + unit) <= width) {
    lines.back() += " " + unit;
    return lines;
  }
  if (lines.size() == most) lines = wrapped(words, width_of, width, most - 1);
  lines.push_back(unit);
  return lines;
}

}  // namespace fascia::io
