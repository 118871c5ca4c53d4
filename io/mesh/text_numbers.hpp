#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Words of text files as numbers, whatever the locale.
namespace fascia::io {

/// Between words: blanks, tabs, and the ends of lines of every system.
constexpr bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// A whole number that is all of the word, or nothing.
std::optional<std::int64_t> to_integer(std::string_view word);

/// A finite number that is all of the word, or nothing.
std::optional<double> to_number(std::string_view word);

/// Where a line ends, and the next one begins: at \n, \r\n, or \r alone as old systems have it.
struct LineEnd {
  std::size_t end = 0, next = 0;
};
LineEnd line_end(std::string_view text, std::size_t begin);

/// A text without what some programs put around it: the mark of UTF-8 at its start; zero bytes and the end-of-file mark
/// of CP/M (0x1A) behind its last line.
struct BareText {
  std::string_view text;
  std::size_t stray = 0;  ///< bytes left out at the end, blanks between them not counted

  explicit BareText(std::string_view whole);
  /// Adds a message where bytes were left out. @param file  for the message
  void report(const std::string& file, std::vector<std::string>& messages) const;
};

/// A word as it may stand in a message: short, printable, in quotes.
std::string quoted(std::string_view word);

}  // namespace fascia::io
