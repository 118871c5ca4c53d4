#include "app/scene/toml_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

std::string toml_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (byte < 0x20 || byte == 0x7f)
      out += fmt::format("\\u{:04X}", byte);
    else
      out += c;
  }
  return out + "\"";
}

/// With a point or an exponent: a whole number would be of another type.
std::string number_text(double number) {
  if (std::isnan(number)) return "nan";
  if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
  std::string text = fmt::format("{}", number);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

struct Writer {
  std::string operator()(const Date&) const { return toml_string("a date"); }
  std::string operator()(bool b) const { return b ? "true" : "false"; }
  std::string operator()(std::int64_t whole) const { return fmt::format("{}", whole); }
  std::string operator()(double number) const { return number_text(number); }
  std::string operator()(const std::string& text) const { return toml_string(text); }
  std::string operator()(const Array& items) const {
    std::string out;
    for (const Value& item : items) out += (out.empty() ? "" : ", ") + toml_text(item);
    return "[" + out + "]";
  }
  std::string operator()(const Table& members) const {
    std::string out;
    for (const Member& member : members)
      out += fmt::format("{}{} = {}", out.empty() ? "" : ", ", toml_key(member.key), toml_text(member.value));
    return out.empty() ? "{}" : "{ " + out + " }";
  }
};

}  // namespace

std::string toml_text(const Value& value) { return std::visit(Writer{}, value.data); }

std::string toml_key(std::string_view key) {
  const auto bare = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !key.empty() && std::all_of(key.begin(), key.end(), bare) ? std::string(key) : toml_string(key);
}

}  // namespace fascia::app
