#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::io {

/// The lines of a text mesh, one after the other, as words; errors name the file and the line.
class TextLines {
 public:
  /// @param comment  the rest of a line from this character on says nothing; 0: lines have no comments
  TextLines(std::string_view text, std::string name, char comment)
      : text_(text), name_(std::move(name)), comment_(comment) {}

  /// Goes to the next line that has any words. @return  false at the end, where there are none
  bool next();
  std::vector<std::string_view>& words() { return words_; }
  const std::vector<std::string_view>& words() const { return words_; }
  /// Gives the text behind the line.
  std::string_view rest() const { return text_.substr(place_); }

  /// Word of the line as messages name it, or that there is none.
  std::string found(std::size_t word) const;
  /// @throws InputError  "NAME:LINE: message"
  [[noreturn]] void fail(const std::string& message) const;
  /// A finite number. @param of  whose it is, for messages
  double coordinate(std::size_t word, const std::string& of) const;
  /// How many there are of something. @param shortest  bytes that each of them takes at least
  std::int64_t count(std::size_t word, const std::string& what, std::int64_t shortest) const;
  /// A vertex of a face, by its number from 0.
  std::int64_t vertex(std::size_t word, const std::string& face, std::int64_t vertices) const;

 private:
  std::string_view text_;
  std::string name_;
  char comment_;
  std::size_t place_ = 0;
  int line_ = 0;
  std::vector<std::string_view> words_;
};

}  // namespace fascia::io
