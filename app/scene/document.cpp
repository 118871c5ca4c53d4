#include "app/scene/document.hpp"

#include "app/reader/text_checks.hpp"

#include <fmt/format.h>

// toml++ 3.3 asserts (or, without assertions, lets the compiler assume) things that a wrong text breaks, "[%]" for one;
// just after, it reports them properly. These two lines leave it at that.
#undef NDEBUG
#define TOML_ASSERT(expression) static_assert(true)
#include <toml++/toml.h>

#include <algorithm>

namespace fascia::app {
namespace {

Position position_of(const toml::source_region& region) {
  return {static_cast<int>(region.begin.line), static_cast<int>(region.begin.column), false};
}

/// Refuses, without parsing, what the parser does not bear: tables nested so deep that walking them overflows the stack
/// (brackets and the parts of dotted keys count), and bytes beyond ASCII outside texts and comments.
class Scan {
 public:
  explicit Scan(std::string_view text) : text_(text) {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = line_start_ = 3;
  }

  /// @throws SyntaxError  where the text goes too deep
  void check() {
    while (at_ < text_.size()) step();
  }

 private:
  void step() {
    const char c = text_[at_];
    if (c == '"' || c == '\'') {
      skip_string(c);
    } else if (c == '#') {
      skip_to_line_end();
    } else {
      count(c);
      ++at_;
    }
  }

  void count(char c) {
    if (c == '.') ++dots_;
    if (c == '[' || c == '{') open();
    if ((c == ']' || c == '}') && !outer_.empty()) close();
    if (c == '\n' || c == ',') dots_ = 0;
    if (c == '\n') {
      ++line_;
      line_start_ = at_ + 1;
    }
    if (depth_ + dots_ > max_nesting) fail(fmt::format("nested more than {} levels deep", max_nesting));
    if (static_cast<unsigned char>(c) >= 0x80) fail("a character beyond ASCII outside quotes");
  }

  [[noreturn]] void fail(std::string message) const {
    throw SyntaxError{{line_, static_cast<int>(at_ - line_start_) + 1, false}, std::move(message)};
  }

  void open() {
    outer_.push_back(depth_);
    depth_ += dots_ + 1;
    dots_ = 0;
  }

  void close() {
    depth_ = outer_.back();
    outer_.pop_back();
    dots_ = 0;
  }

  void skip_string(char quote) {
    const std::string triple(3, quote);
    const bool is_long = text_.compare(at_, 3, triple) == 0;
    at_ += is_long ? 3 : 1;
    while (at_ < text_.size()) {
      if (is_long ? text_.compare(at_, 3, triple) == 0 : text_[at_] == quote) {
        at_ += is_long ? 3 : 1;
        return;
      }
      if (text_[at_] == '\n') {
        if (!is_long) return;
        count('\n');
      }
      at_ += text_[at_] == '\\' && quote == '"' && at_ + 1 < text_.size() && text_[at_ + 1] != '\n' ? 2 : 1;
    }
  }

  void skip_to_line_end() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
  }

  std::string_view text_;
  std::size_t at_ = 0, line_start_ = 0;
  int line_ = 1;
  int dots_ = 0;            ///< of the key or value at hand
  int depth_ = 0;           ///< of the innermost bracket
  std::vector<int> outer_;  ///< depths outside each open bracket
};

Value convert(const toml::node& node);

Table convert_table(const toml::table& table) {
  Table members;
  members.reserve(table.size());
  for (auto&& [key, node] : table)
    members.push_back({std::string(key.str()), position_of(key.source()), convert(node)});
  std::stable_sort(members.begin(), members.end(), [](const Member& a, const Member& b) {
    return std::pair(a.position.line, a.position.column) < std::pair(b.position.line, b.position.column);
  });
  return members;
}

Array convert_array(const toml::array& array) {
  Array items;
  items.reserve(array.size());
  for (const toml::node& node : array) items.push_back(convert(node));
  return items;
}

Value convert(const toml::node& node) {
  Value value;
  value.position = position_of(node.source());
  if (const auto* table = node.as_table())
    value.data = convert_table(*table);
  else if (const auto* array = node.as_array())
    value.data = convert_array(*array);
  else if (const auto* text = node.as_string())
    value.data = text->get();
  else if (const auto* integer = node.as_integer())
    value.data = integer->get();
  else if (const auto* number = node.as_floating_point())
    value.data = number->get();
  else if (const auto* boolean = node.as_boolean())
    value.data = boolean->get();
  return value;
}

}  // namespace

const Value* Value::find(std::string_view key) const {
  const Table* table = as_table();
  if (!table) return nullptr;
  const auto found = std::find_if(table->begin(), table->end(), [&](const Member& m) { return m.key == key; });
  return found == table->end() ? nullptr : &found->value;
}

Value* Value::find(std::string_view key) { return const_cast<Value*>(std::as_const(*this).find(key)); }

Value parse_toml(std::string_view text) {
  check_encoding(text);
  try {
    Scan(text).check();
    try {
      return convert(toml::parse(text));
    } catch (const toml::parse_error& error) {
      throw SyntaxError{position_of(error.source()), std::string(error.description())};
    }
  } catch (const SyntaxError& error) {
    throw unquoted_quantity(text, error.position.line).value_or(error);
  }
}

}  // namespace fascia::app
