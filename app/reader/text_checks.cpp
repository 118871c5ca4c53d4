#include "app/reader/text_checks.hpp"
#include "app/scene/trimmed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>

namespace fascia::app {
namespace {

unsigned byte_at(std::string_view text, std::size_t at) { return static_cast<unsigned char>(text[at]); }

/// Bytes of the UTF-8 character at the start of a text that is not empty (RFC 3629); 0 where there is none.
std::size_t character_size(std::string_view text) {
  const unsigned first = byte_at(text, 0);
  if (first < 0x80) return 1;
  const std::size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < size) return 0;
  for (std::size_t k = 1; k < size; ++k)
    if ((byte_at(text, k) & 0xC0) != 0x80) return 0;
  const unsigned second = byte_at(text, 1);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool none = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);
  return overlong || none ? 0 : size;
}

int characters_of(std::string_view text) {
  return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

/// The encoding that a text seems to have, as iconv calls it; empty where it is not of 16 or 32 bits.
std::string_view wide_encoding(std::string_view text) {
  using namespace std::string_view_literals;
  if (text.starts_with("\xFF\xFE\0\0"sv) || text.starts_with("\0\0\xFE\xFF"sv)) return "UTF-32";
  if (text.starts_with("\xFF\xFE"sv) || text.starts_with("\xFE\xFF"sv)) return "UTF-16";
  if (text.size() < 2 || (text[0] != '\0') == (text[1] != '\0')) return "";
  return text[0] != '\0' ? "UTF-16LE" : "UTF-16BE";
}

std::string_view line_of(std::string_view text, int line) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  for (int k = 1; k < line; ++k) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find_first_of("\r\n"));
}

/// The number with a unit that a text starts with; empty where it starts with something else, or is a key.
std::string_view quantity_at(std::string_view text) {
  constexpr std::size_t longest = 60;
  const std::size_t sign = text[0] == '+' ? 1 : 0;
  double number = 0;
  const auto [end, error] = std::from_chars(text.data() + sign, text.data() + text.size(), number);
  if (error != std::errc{} || std::isalpha(static_cast<unsigned char>(end[-1])) != 0) return {};
  const auto length = static_cast<std::size_t>(end - text.data());
  const std::string_view rest = text.substr(length);
  const bool other_base = text.substr(sign, length - sign) == "0" && rest.find_first_of("xob") == 0;
  const std::size_t stop = rest.find_first_of(",]}#\"'=");
  const std::string_view unit = trimmed(rest.substr(0, stop));
  if (unit.empty() || other_base || (stop != std::string_view::npos && rest[stop] == '=')) return {};
  const bool begins = std::isalpha(static_cast<unsigned char>(unit[0])) != 0 || byte_at(unit, 0) >= 0x80;
  if (!begins || unit.size() > longest) return {};
  return text.substr(0, static_cast<std::size_t>(unit.data() + unit.size() - text.data()));
}

}  // namespace

void check_encoding(std::string_view text) {
  const auto converted = [](std::string_view from) {
    return fmt::format("save it as UTF-8, or convert it: iconv -f {} -t UTF-8 OLD.toml > NEW.toml", from);
  };
  if (const std::string_view wide = wide_encoding(text); !wide.empty())
    throw SyntaxError{{}, fmt::format("the text is {} and must be UTF-8", wide), converted(wide)};
  Position place;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t size = character_size(text.substr(at));
    if (size == 0)
      throw SyntaxError{place, fmt::format("the byte 0x{:02X} is no UTF-8; it may be Latin-1", byte_at(text, at)),
                        converted("LATIN1")};
    ++place.column;
    if (text[at] == '\n') place = {place.line + 1, 1, false};
    at += size;
  }
}

std::optional<SyntaxError> unquoted_quantity(std::string_view text, int line) {
  const std::string_view row = line_of(text, line);
  char quote = 0;
  bool begins = true;         // a value may stand here
  std::size_t key_begin = 0;  // what stands from here to an = is a key
  std::string_view key;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const char c = row[i];
    if (quote != 0) {
      if (c == '\\' && quote == '"') ++i;
      if (c == quote) quote = 0;
      continue;
    }
    if (c == '#') break;
    if (c == ' ' || c == '\t') continue;
    if (c == '"' || c == '\'') quote = c;
    if (begins) {
      if (const std::string_view found = quantity_at(row.substr(i)); !found.empty()) {
        const std::string name = key.empty() ? "" : fmt::format("{} = ", key);
        return SyntaxError{{line, characters_of(row.substr(0, i)) + 1, false},
                           fmt::format("a value with a unit stands in quotes: {}\"{}\"", name, found),
                           ""};
      }
    }
    begins = c == '=' || c == '[' || c == ',';
    key = c == '=' ? trimmed(row.substr(key_begin, i - key_begin)) : std::string_view{};
    if (c == '{' || c == ',') key_begin = i + 1;
  }
  return std::nullopt;
}

}  // namespace fascia::app
