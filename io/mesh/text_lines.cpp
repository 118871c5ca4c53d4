#include "io/mesh/text_lines.hpp"

#include "core/base/errors.hpp"
#include "io/mesh/text_numbers.hpp"

namespace fascia::io {

bool TextLines::next() {
  words_.clear();
  while (words_.empty() && place_ < text_.size()) {
    const LineEnd at = line_end(text_, place_);
    std::string_view line = text_.substr(place_, at.end - place_);
    place_ = at.next;
    ++line_;
    if (comment_ != 0) line = line.substr(0, line.find(comment_));
    for (std::size_t begin = 0, stop = 0; begin < line.size(); begin = stop) {
      while (begin < line.size() && is_blank(line[begin])) ++begin;
      for (stop = begin; stop < line.size() && !is_blank(line[stop]);) ++stop;
      if (stop > begin) words_.push_back(line.substr(begin, stop - begin));
    }
  }
  return !words_.empty();
}

std::string TextLines::found(std::size_t word) const {
  if (word < words_.size()) return quoted(words_[word]);
  return words_.empty() ? "the end of the file" : "the end of the line";
}

void TextLines::fail(const std::string& message) const {
  throw InputError(name_ + ":" + std::to_string(line_) + ": " + message);
}

double TextLines::coordinate(std::size_t word, const std::string& of) const {
  const std::optional<double> value = word < words_.size() ? to_number(words_[word]) : std::nullopt;
  if (!value) fail("expected a coordinate of " + of + ", found " + found(word) + "; must be a finite number");
  return *value;
}

std::int64_t TextLines::count(std::size_t word, const std::string& what, std::int64_t shortest) const {
  const std::optional<std::int64_t> number = word < words_.size() ? to_integer(words_[word]) : std::nullopt;
  if (!number || *number < 0)
    fail("expected the number of " + what + ", found " + found(word) + "; must be a whole number");
  if (*number > static_cast<std::int64_t>(text_.size()) / shortest)
    fail("the number of " + what + " is " + std::to_string(*number) + ", but the file has only " +
         std::to_string(text_.size()) + " bytes; it is cut off or the number is wrong: write it again");
  return *number;
}

std::int64_t TextLines::vertex(std::size_t word, const std::string& face, std::int64_t vertices) const {
  const std::optional<std::int64_t> vertex = word < words_.size() ? to_integer(words_[word]) : std::nullopt;
  if (!vertex) fail("expected a vertex of " + face + ", found " + found(word) + "; must be a whole number");
  if (*vertex < 0 || *vertex >= vertices)
    fail(face + " uses vertex " + std::to_string(*vertex) + ", but there are " + std::to_string(vertices) +
         ", counted from 0; correct the face");
  return *vertex;
}

}  // namespace fascia::io
