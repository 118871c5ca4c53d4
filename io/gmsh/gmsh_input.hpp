#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace fascia::io {

/// The text of a Gmsh file and a place in it: numbers as words, or as bytes where the file is binary.
class GmshInput {
 public:
  GmshInput(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {}

  void set_binary(bool binary) { binary_ = binary; }
  bool binary() const { return binary_; }

  /// The next word of the text; empty at the end of it, or of a line that a record must not leave.
  std::string_view word();
  /// What is left of the line, without its end; the place moves to the next line.
  std::string_view rest_of_line();
  /// In an ASCII file the record that follows must end with its line: words up to end_of_line() come from one line.
  void begin_line();
  /// Only blanks may be left on the line. @param what  for the message
  void end_of_line(const std::string& what);
  /// Moves behind the next line that is `line`; fails at the end of the file.
  void skip_past_line(const std::string& line);
  bool at_end();

  // Numbers, as words in ASCII files. `what` names them in messages.
  std::int64_t text_integer(const char* what);
  double text_number(const char* what);
  std::int64_t int32(const char* what);  ///< four bytes in binary files
  std::int64_t size(const char* what);   ///< eight bytes in binary files
  double number(const char* what);       ///< must be finite; eight bytes in binary files

  /// Fails unless `count` records of at least so many bytes fit into what is left.
  /// @param text_bytes    least bytes of a record in an ASCII file
  /// @param binary_bytes  least bytes of a record in a binary file
  std::size_t checked_count(std::int64_t count, std::size_t text_bytes, std::size_t binary_bytes,
                            const char* what) const;

  /// Throws InputError with the place of what was read last.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string found(std::string_view word) const;
  template <class T>
  T bytes(const char* what);

  std::string_view text_;
  std::string name_;
  std::size_t place_ = 0;  ///< of what is next
  std::size_t last_ = 0;   ///< of what was read last
  bool binary_ = false;
  bool one_line_ = false;
};

}  // namespace fascia::io
