#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// A TOML text as a tree of values that know where they stand.
namespace fascia::app {

/// Line and column count from one.
struct Position {
  int line = 1, column = 1;
  bool from_override = false;  ///< stands on the command line (--set), not in the scene file
};

struct Value;
struct Member;
using Array = std::vector<Value>;
using Table = std::vector<Member>;

/// A date or time of day; no key of a scene takes one.
struct Date {};

/// A TOML value.
struct Value {
  Position position;
  bool usable = true;  ///< false once something wrong with it has been reported
  std::variant<Date, bool, std::int64_t, double, std::string, Array, Table> data;

  const Table* as_table() const { return std::get_if<Table>(&data); }
  Table* as_table() { return std::get_if<Table>(&data); }
  const Array* as_array() const { return std::get_if<Array>(&data); }
  Array* as_array() { return std::get_if<Array>(&data); }
  const std::string* as_string() const { return std::get_if<std::string>(&data); }

  /// The member of a table; null where there is none or this is no table.
  const Value* find(std::string_view key) const;
  Value* find(std::string_view key);
};

/// A key of a table and its value, in the order of the text.
struct Member {
  std::string key;
  Position position;  ///< of the key
  Value value;
};

/// A text that is not TOML.
struct SyntaxError {
  Position position;
  std::string message;
  std::string remedy = "must be TOML 1.0";  ///< empty where the message holds it
};

/// Texts whose brackets and dotted keys nest deeper are refused.
inline constexpr int max_nesting = 256;

/// Reads a TOML 1.0 text in UTF-8.
/// @throws SyntaxError  at its first mistake
Value parse_toml(std::string_view text);

}  // namespace fascia::app
