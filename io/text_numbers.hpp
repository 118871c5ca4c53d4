#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Words of text files as numbers, whatever the locale.
namespace fascia::io {

/// Between words: blanks, tabs, and the ends of lines of every system.
constexpr bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// A whole number that is all of the word, or nothing.
std::optional<std::int64_t> to_integer(std::string_view word);

/// A finite number that is all of the word, or nothing.
std::optional<double> to_number(std::string_view word);

/// A word as it may stand in a message: short, printable, in quotes.
std::string quoted(std::string_view word);

}  // namespace fascia::io
