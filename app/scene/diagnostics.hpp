#pragma once

#include "app/scene/document.hpp"
#include "assembly/specification/errors.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace fascia::app {

/// Collects what is wrong with a scene.
class Diagnostics {
 public:
  /// @param file  the scene file as the user named it
  explicit Diagnostics(std::string file) : file_(std::move(file)) {}

  Place place(const Position& position, std::string_view path) const;
  void add(const Position& position, std::string_view path, std::string message);
  void add(Place place, std::string message);
  bool empty() const { return found_.empty(); }
  /// Whether further errors are only counted.
  bool is_full() const;

  /// @throws SceneError  with everything found, sorted by place, if there is anything
  void throw_if_any();

 private:
  std::string file_;
  std::vector<Diagnostic> found_;
  std::size_t left_out_ = 0;  ///< errors of hopeless files are counted, not kept
};

/// `path` with one more key; keys that are not plain are quoted and escaped.
std::string join(std::string_view path, std::string_view key);
/// `path` with an index that counts from zero.
std::string join(std::string_view path, std::size_t index);

/// A value as the user wrote it, on one line and not too long: "5 kg", 0.6, true, a list, a table.
std::string describe(const Value& value);

/// A text whose control characters are written as \n, \t or \xNN.
std::string one_line(std::string_view text);

/// A text in double quotes, on one line, shortened to about 60 characters.
std::string in_quotes(std::string_view text);

/// "a", "a or b", "a, b or c"
std::string join_or(const std::vector<std::string>& parts);

/// `"knee" is no known body; did you mean "knees"?`, or with the known names.
std::string unknown_name(const std::string& what, const std::string& name, const std::vector<std::string>& known);

/// The word of `known` that `word` most likely means; empty where none is near.
std::string nearest(std::string_view word, const std::vector<std::string>& known);

}  // namespace fascia::app
