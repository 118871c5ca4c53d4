#include "io/gmsh/gmsh_input.hpp"

#include "core/base/errors.hpp"
#include "io/mesh/text_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace fascia::io {
std::string GmshInput::found(std::string_view word) const {
  if (!word.empty()) return quoted(word);
  return place_ < text_.size() ? "the end of the line" : "the end of the file";
}

std::string_view GmshInput::word() {
  while (place_ < text_.size() && is_blank(text_[place_]) && !(one_line_ && text_[place_] == '\n')) ++place_;
  last_ = place_;
  while (place_ < text_.size() && !is_blank(text_[place_])) ++place_;
  return text_.substr(last_, place_ - last_);
}

std::string_view GmshInput::rest_of_line() {
  last_ = place_;
  const std::size_t end = std::min(text_.find('\n', place_), text_.size());
  place_ = std::min(end + 1, text_.size());
  std::string_view line = text_.substr(last_, end - last_);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

void GmshInput::begin_line() {
  if (binary_ || at_end()) return;
  one_line_ = true;
}

void GmshInput::end_of_line(const std::string& what) {
  if (binary_) return;
  one_line_ = false;
  while (place_ < text_.size() && text_[place_] != '\n' && is_blank(text_[place_])) ++place_;
  if (place_ == text_.size() || text_[place_] == '\n') return;
  const std::string_view extra = word();
  fail(what + " is followed by " + quoted(extra) + "; the line must end there");
}

void GmshInput::skip_past_line(const std::string& line) {
  std::size_t found = place_;
  while ((found = text_.find(line, found)) != std::string_view::npos) {
    const std::size_t end = found + line.size();
    const bool starts = found == 0 || text_[found - 1] == '\n';
    if (starts && (end == text_.size() || is_blank(text_[end]))) {
      place_ = end;
      return;
    }
    found = end;
  }
  fail("the section has no " + line + "; the file is cut off: write it again");
}

bool GmshInput::at_end() {
  while (place_ < text_.size() && is_blank(text_[place_])) ++place_;
  return place_ == text_.size();
}

std::int64_t GmshInput::text_integer(const char* what) {
  const std::string_view text = word();
  const std::optional<std::int64_t> value = to_integer(text);
  if (!value) fail(std::string("expected ") + what + ", found " + found(text) + "; must be a whole number");
  return *value;
}

double GmshInput::text_number(const char* what) {
  const std::string_view text = word();
  const std::optional<double> value = to_number(text);
  if (!value) fail(std::string("expected ") + what + ", found " + found(text) + "; must be a finite number");
  return *value;
}

template <class T>
T GmshInput::bytes(const char* what) {
  last_ = place_;
  if (text_.size() - place_ < sizeof(T)) fail(std::string("the file ends before ") + what + "; write it again");
  T value;
  std::memcpy(&value, text_.data() + place_, sizeof(T));
  place_ += sizeof(T);
  return value;
}

std::int64_t GmshInput::int32(const char* what) { return binary_ ? bytes<std::int32_t>(what) : text_integer(what); }

std::int64_t GmshInput::size(const char* what) {
  if (!binary_) return text_integer(what);
  const auto value = bytes<std::uint64_t>(what);
  if (value > static_cast<std::uint64_t>(INT64_MAX)) fail(std::string(what) + " is too large; the file is damaged");
  return static_cast<std::int64_t>(value);
}

double GmshInput::number(const char* what) {
  if (!binary_) return text_number(what);
  const auto value = bytes<double>(what);
  if (!std::isfinite(value)) fail(std::string(what) + " is not finite; must be a finite number");
  return value;
}

std::size_t GmshInput::checked_count(std::int64_t count, std::size_t text_bytes, std::size_t binary_bytes,
                                     const char* what) const {
  const std::size_t left = text_.size() - place_, least = binary_ ? binary_bytes : text_bytes;
  if (count < 0 || static_cast<std::uint64_t>(count) > left / least)
    fail(std::string(what) + " is " + std::to_string(count) + ", but only " + std::to_string(left) +
         " bytes follow; the file is cut off or the number is wrong: write it again");
  return static_cast<std::size_t>(count);
}

void GmshInput::fail(const std::string& message) const {
  if (binary_) throw InputError(name_ + ": byte " + std::to_string(last_) + ": " + message);
  const auto begin = text_.begin();
  const auto line = 1 + std::count(begin, begin + static_cast<std::ptrdiff_t>(last_), '\n');
  throw InputError(name_ + ":" + std::to_string(line) + ": " + message);
}

}  // namespace fascia::io
