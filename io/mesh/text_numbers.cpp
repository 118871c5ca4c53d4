#include "io/mesh/text_numbers.hpp"

#include <charconv>
#include <cmath>
#include <cstdlib>

namespace fascia::io {
namespace {

std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  return word;
}

}  // namespace

LineEnd line_end(std::string_view text, std::size_t begin) {
  const std::size_t end = text.find_first_of("\r\n", begin);
  if (end == std::string_view::npos) return {text.size(), text.size()};
  return {end, end + (text.substr(end, 2) == "\r\n" ? 2 : 1)};
}

std::optional<std::int64_t> to_integer(std::string_view word) {
  word = without_plus(word);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<double> to_number(std::string_view word) {
  word = without_plus(word);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) return std::nullopt;
  // Too small for a double is zero, too large is not finite: strtod tells the two apart.
  if (error == std::errc::result_out_of_range) value = std::strtod(std::string(word).c_str(), nullptr);
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

BareText::BareText(std::string_view whole) : text(whole) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  if (text.starts_with(mark)) text.remove_prefix(mark.size());
  std::string_view rest = text;
  while (!rest.empty() && (is_blank(rest.back()) || rest.back() == '\0' || rest.back() == '\x1A')) {
    stray += is_blank(rest.back()) ? 0u : 1u;
    rest.remove_suffix(1);
  }
  if (stray > 0) text = rest;
}

void BareText::report(const std::string& file, std::vector<std::string>& messages) const {
  if (stray == 0) return;
  messages.push_back(
      file + ": left out " + std::to_string(stray) +
      (stray == 1 ? " byte behind the last line that belongs" : " bytes behind the last line that belong") +
      " to no text");
}

std::string quoted(std::string_view word) {
  constexpr std::size_t longest = 40;
  std::string result = "\"";
  for (const char c : word.substr(0, longest)) result += c >= ' ' && c <= '~' ? c : '?';
  return result + (word.size() > longest ? "...\"" : "\"");
}

}  // namespace fascia::io
