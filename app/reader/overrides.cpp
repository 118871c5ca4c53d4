#include "app/reader/overrides.hpp"

#include "app/reader/text_checks.hpp"
#include "app/scene/trimmed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>

namespace fascia::app {
namespace {

constexpr std::size_t max_parts = 64;

struct Part {
  std::string key;
  int column = 1;
};

Position at_column(int column) { return {1, column, true}; }

/// Where the value starts: the first "=" outside quotes.
std::size_t find_equals(std::string_view text) {
  bool inside = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') inside = !inside;
    if (text[i] == '=' && !inside) return i;
  }
  return std::string_view::npos;
}

/// "constraints[0].where" → constraints, 0, where. Quoted parts may hold dots.
std::vector<Part> split_path(std::string_view path) {
  std::vector<Part> parts{{"", 1}};
  bool inside = false;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const char c = path[i];
    if (c == '"')
      inside = !inside;
    else if (!inside && (c == '.' || c == '['))
      parts.push_back({"", static_cast<int>(i) + 2});
    else if (inside || (c != ']' && c != ' '))
      parts.back().key += c;
  }
  return parts;
}

std::optional<std::size_t> as_index(const std::string& key) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
  if (error != std::errc{} || end != key.data() + key.size()) return std::nullopt;
  return index;
}

/// Gives every position inside a value the place on the command line; `shift` columns to the right.
void move_to_command_line(Value& value, int shift) {
  value.position = at_column(std::max(1, value.position.column + shift));
  if (Array* items = value.as_array())
    for (Value& item : *items) move_to_command_line(item, shift);
  if (Table* members = value.as_table())
    for (Member& member : *members) {
      member.position = at_column(std::max(1, member.position.column + shift));
      move_to_command_line(member.value, shift);
    }
}

/// @param column  where the text stands
Value parse_value(std::string_view text, int column) {
  constexpr std::string_view prefix = "v = ";
  try {
    Value document = parse_toml(std::string(prefix) + std::string(text));
    if (document.as_table()->size() == 1) {
      Value value = std::move(document.as_table()->front().value);
      move_to_command_line(value, column - static_cast<int>(prefix.size()) - 1);
      return value;
    }
  } catch (const SyntaxError&) {
    // Not TOML: a bare text.
  }
  Value bare;
  bare.data = std::string(text);
  bare.position = at_column(column);
  return bare;
}

/// Follows one part of the path; null, with a message, where it leads nowhere.
Value* step(Value& at, const Part& part, const std::string& path, Diagnostics& diagnostics) {
  if (Array* items = at.as_array()) {
    const std::optional<std::size_t> index = as_index(part.key);
    if (index && *index < items->size()) return &(*items)[*index];
    const std::string range =
        items->empty() ? "the list is empty" : fmt::format("must be from 0 to {}", items->size() - 1);
    diagnostics.add(at_column(part.column), path,
                    fmt::format("{} is no index of this list; {}", in_quotes(part.key), range));
    return nullptr;
  }
  Table* members = at.as_table();
  if (!members) {
    diagnostics.add(at_column(part.column), path,
                    fmt::format("{} has no key {}; set the whole value", describe(at), in_quotes(part.key)));
    return nullptr;
  }
  if (Value* found = at.find(part.key)) return found;
  Value missing;
  missing.position = at_column(part.column);
  missing.data = Table{};
  members->push_back({part.key, at_column(part.column), std::move(missing)});
  return &members->back().value;
}

/// Why a key cannot be removed.
std::string not_there(const Table& members, const std::string& key) {
  std::vector<std::string> known;
  for (const Member& member : members) known.push_back(member.key);
  const std::string near = nearest(key, known);
  return fmt::format("is not there, so that it cannot be removed; {}",
                     near.empty() ? "leave this --set out" : fmt::format("did you mean \"{}\"?", near));
}

/// Takes a member out of its table, or an element out of its list.
void remove(Value& owner, const Value& removed) {
  if (Array* items = owner.as_array()) {
    items->erase(items->begin() + (&removed - items->data()));
    return;
  }
  Table& members = *owner.as_table();
  members.erase(
      std::find_if(members.begin(), members.end(), [&](const Member& member) { return &member.value == &removed; }));
}

}  // namespace

void apply_override(Value& document, std::string_view text, Diagnostics& diagnostics) {
  try {
    check_encoding(text);
  } catch (const SyntaxError& error) {
    return diagnostics.add(at_column(error.position.column), "", error.message + "; write it in UTF-8");
  }
  const std::size_t equals = find_equals(text);
  if (equals == std::string_view::npos)
    return diagnostics.add(at_column(1), "", fmt::format("{} has no =; must be key.path=value", in_quotes(text)));
  const std::vector<Part> parts = split_path(text.substr(0, equals));
  if (parts.size() > max_parts)
    return diagnostics.add(at_column(1), "", "the key has too many parts; must be key.path=value");
  for (const Part& part : parts)
    if (part.key.empty())
      return diagnostics.add(at_column(part.column), "", "a part of the key is empty; must be key.path=value");
  const std::string_view value = trimmed(text.substr(equals + 1));
  Value *at = &document, *owner = nullptr;
  std::string path;
  for (const Part& part : parts) {
    const bool in_list = at->as_array() != nullptr;
    const std::optional<std::size_t> index = as_index(part.key);
    const std::string whole = in_list && index ? join(path, *index) : join(path, part.key);
    if (value.empty() && at->as_table() && !at->find(part.key))
      return diagnostics.add(at_column(part.column), whole, not_there(*at->as_table(), part.key));
    owner = at;
    at = step(*at, part, in_list && !index ? path : whole, diagnostics);
    if (!at) return;
    path = whole;
  }
  if (value.empty()) return remove(*owner, *at);
  *at = parse_value(value, static_cast<int>(value.data() - text.data()) + 1);
}

}  // namespace fascia::app
