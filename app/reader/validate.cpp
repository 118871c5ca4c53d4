#include "app/reader/validate.hpp"

#include "app/scene/units.hpp"
#include "assembly/specification/domain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace fascia::app {
namespace {

constexpr int max_region_depth = 64;
constexpr std::size_t max_name_length = 100;

bool holds(const Shape& choices, std::string_view value) {
  return std::any_of(choices.choices.begin(), choices.choices.end(), [&](const Choice& c) { return c.value == value; });
}

/// Whether a value could be meant as this shape. `deep`: by its first item too.
bool matches(const Shape& shape, const Value& value, bool deep) {
  const Array* list = value.as_array();
  switch (shape.type) {
    case Type::number:
      return value.as_string() || std::holds_alternative<std::int64_t>(value.data) ||
             std::holds_alternative<double>(value.data);
    case Type::integer:
      return std::holds_alternative<std::int64_t>(value.data);
    case Type::boolean:
      return std::holds_alternative<bool>(value.data);
    case Type::text:
    case Type::choice:
      return value.as_string() != nullptr;
    case Type::array:
    case Type::tuple:
      return list && (!deep || list->empty() || matches(shape.items.front(), list->front(), deep));
    case Type::table:
    case Type::named_tables:
      return value.as_table() != nullptr;
    case Type::one_of:
      return std::any_of(shape.items.begin(), shape.items.end(),
                         [&](const Shape& s) { return matches(s, value, deep); });
    case Type::reference:
      return matches(shape.target(), value, deep);
    case Type::anything:
      return true;
  }
  return false;
}

/// The alternative that a value is meant as; null where it fits none.
const Shape* choose(const Shape& one_of, const Value& value) {
  if (const std::string* word = value.as_string())
    for (const Shape& item : one_of.items)
      if (item.type == Type::choice && holds(item, *word)) return &item;
  for (const bool deep : {true, false})
    for (const Shape& item : one_of.items)
      if (matches(item, value, deep)) return &item;
  return nullptr;
}

bool is_plain_name(std::string_view name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !name.empty() && name.size() <= max_name_length && std::all_of(name.begin(), name.end(), allowed);
}

bool states_need(const Value& scene) {
  if (scene.find("need")) return true;
  const Value* bodies = scene.find("bodies");
  const Table* tables = bodies ? bodies->as_table() : nullptr;
  return tables &&
         std::any_of(tables->begin(), tables->end(), [](const Member& body) { return body.value.find("need"); });
}

class Validator {
 public:
  /// @param needed  the document is a scene that states a need
  Validator(Diagnostics& diagnostics, bool needed) : diagnostics_(diagnostics), needed_(needed) {}

  /// Checks one value; `wanted` says in words what would be right.
  void check(Value& value, const Shape& shape, const std::string& path, const std::string& wanted) {
    switch (shape.type) {
      case Type::number:
        return check_number(value, shape, path, wanted);
      case Type::integer:
        return check_integer(value, shape, path, wanted);
      case Type::text:
        return check_text(value, shape, path, wanted);
      case Type::boolean:
        if (!std::holds_alternative<bool>(value.data)) wrong_type(value, path, wanted);
        return;
      case Type::choice:
        return check_choice(value, shape, path, wanted);
      case Type::array:
      case Type::tuple:
        return check_array(value, shape, path, wanted);
      case Type::table:
        return check_table(value, shape, path, wanted);
      case Type::named_tables:
        return check_named(value, shape, path, wanted);
      case Type::one_of:
        return check_alternatives(value, shape, path, wanted);
      case Type::reference:
        return check_reference(value, shape, path);
      case Type::anything:
        return;
    }
  }

 private:
  void fail(Value& value, const std::string& path, std::string message) {
    value.usable = false;
    diagnostics_.add(value.position, path, std::move(message));
  }

  void wrong_type(Value& value, const std::string& path, const std::string& wanted) {
    fail(value, path, fmt::format("{} is of the wrong type; must be {}", describe(value), wanted));
  }

  void check_number(Value& value, const Shape& shape, const std::string& path, const std::string& wanted) {
    const std::string shown = describe(value);
    if (const auto* whole = std::get_if<std::int64_t>(&value.data)) value.data = static_cast<double>(*whole);
    if (const std::string* quantity = value.as_string()) {
      const auto result = parse_quantity(*quantity, shape.unit);
      if (const auto* error = std::get_if<UnitError>(&result)) return fail(value, path, error->message);
      value.data = std::get<double>(result);
    }
    const auto* number = std::get_if<double>(&value.data);
    if (!number) return wrong_type(value, path, wanted);
    if (!std::isfinite(*number)) return fail(value, path, fmt::format("{} is not finite; must be {}", shown, wanted));
    if (!shape.range.contains(*number))
      return fail(value, path, fmt::format("{} is out of range; must be {}", shown, shape.range.text()));
    const bool tiny = shape.range.min >= 0 && *number > 0 && *number < kShortest;
    if (shape.unit == "m" && (tiny || std::abs(*number) > kLongest))
      fail(value, path,
           fmt::format("{} is a length whose volume or moment of inertia double numbers cannot hold; must be {} {} m",
                       shown, tiny ? "at least" : "at most", tiny ? kShortest : kLongest));
  }

  void check_integer(Value& value, const Shape& shape, const std::string& path, const std::string& wanted) {
    const auto* whole = std::get_if<std::int64_t>(&value.data);
    if (!whole) return wrong_type(value, path, wanted);
    if (!shape.range.contains(static_cast<double>(*whole)))
      fail(value, path, fmt::format("{} is out of range; must be {}", *whole, shape.range.text()));
  }

  void check_text(Value& value, const Shape& shape, const std::string& path, const std::string& wanted) {
    const std::string* words = value.as_string();
    if (!words) return wrong_type(value, path, wanted);
    if (shape.of_lines) return;
    const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
    if (std::any_of(words->begin(), words->end(), is_control))
      fail(value, path, fmt::format("{} holds a control character; must be one line of text", describe(value)));
  }

  void check_choice(Value& value, const Shape& shape, const std::string& path, const std::string& wanted) {
    const std::string* word = value.as_string();
    if (!word) return wrong_type(value, path, wanted);
    const std::vector<std::string> supported = supported_values(shape);
    if (std::find(supported.begin(), supported.end(), *word) != supported.end()) return;
    if (holds(shape, *word))
      return fail(value, path, fmt::format("{} is not supported yet; must be {}", in_quotes(*word), wanted));
    const std::string near = nearest(*word, supported);
    const std::string hint = near.empty() || supported.size() == 1 ? "" : fmt::format(" (did you mean \"{}\"?)", near);
    fail(value, path, fmt::format("{} is no known value; must be {}{}", in_quotes(*word), wanted, hint));
  }

  void check_array(Value& value, const Shape& shape, const std::string& path, const std::string& wanted) {
    Array* list = value.as_array();
    if (!list) return wrong_type(value, path, wanted);
    if (list->size() < shape.min_items || list->size() > shape.max_items)
      return fail(value, path, fmt::format("{} is of the wrong length; must be {}", describe(value), wanted));
    std::size_t index = 0;
    for (Value& item : *list) {
      const Shape& kind = shape.type == Type::tuple ? shape.items[index] : shape.items.front();
      check(item, kind, join(path, index++), in_words(kind));
      value.usable = value.usable && item.usable;
    }
  }

  void check_alternatives(Value& value, const Shape& shape, const std::string& path, const std::string& wanted) {
    const Shape* chosen = choose(shape, value);
    if (!chosen) return wrong_type(value, path, wanted);
    check(value, *chosen, path, chosen->type == Type::choice ? wanted : in_words(*chosen));
  }

  void check_reference(Value& value, const Shape& shape, const std::string& path) {
    if (depth_ >= max_region_depth)
      return fail(value, path,
                  fmt::format("the {}s are nested too deeply; at most {} levels", shape.name, max_region_depth));
    ++depth_;
    check(value, shape.target(), path, in_words(shape.target()));
    --depth_;
  }

  void check_named(Value& value, const Shape& shape, const std::string& path, const std::string& wanted) {
    Table* members = value.as_table();
    if (!members) return wrong_type(value, path, wanted);
    if (members->size() < shape.min_items) fail(value, path, "is empty; needs at least one entry");
    for (Member& member : *members) {
      const std::string member_path = join(path, member.key);
      if (shape.plain_names && !is_plain_name(member.key))
        diagnostics_.add(member.position, member_path,
                         fmt::format("{} cannot name a file; use up to {} letters, digits, _ and -",
                                     in_quotes(member.key), max_name_length));
      named_ = {member_path, member.key, members};
      check(member.value, shape.items.front(), member_path, in_words(shape.items.front()));
    }
  }

  void check_table(Value& value, const Shape& shape, const std::string& path, const std::string& wanted) {
    Table* members = value.as_table();
    if (!members) return wrong_type(value, path, wanted);
    if (is_moot(value, shape, path)) {
      value.usable = false;
      return;
    }
    for (Member& member : *members) check_member(member, shape, path);
    for (const Key& k : shape.keys)
      if (k.required && !value.find(k.name))
        diagnostics_.add(value.position, join(path, k.name),
                         fmt::format("is missing; must be {}{}", in_words(k.shape), other_name(path)));
    for (const Exclusive& group : shape.exclusive) check_exclusive(value, shape, group, path);
  }

  /// Another name that the named table of this path may be meant as, which --set or a heading has begun: "baem", beside
  /// "beam".
  std::string other_name(const std::string& path) const {
    if (named_.among == nullptr || path != named_.path) return "";
    std::vector<std::string> others;
    for (const Member& other : *named_.among)
      if (other.key != named_.key) others.push_back(other.key);
    const std::string similar = nearest(named_.key, others);
    return similar.empty() ? "" : fmt::format("; or did you mean {}?", in_quotes(similar));
  }

  /// Reports a selector that is not supported; what else the table says then does not matter.
  bool is_moot(Value& value, const Shape& shape, const std::string& path) {
    Value* selector = shape.selector.empty() ? nullptr : value.find(shape.selector);
    const std::string* word = selector ? selector->as_string() : nullptr;
    if (!word) return false;
    const Shape& choices = shape.find(shape.selector)->shape;
    const std::vector<std::string> supported = supported_values(choices);
    if (!holds(choices, *word) || std::find(supported.begin(), supported.end(), *word) != supported.end()) return false;
    check_choice(*selector, choices, join(path, shape.selector), in_words(choices));
    return true;
  }

  void check_member(Member& member, const Shape& shape, const std::string& path) {
    const std::string member_path = join(path, member.key);
    const Key* known = shape.find(member.key);
    if (!known) {
      member.value.usable = false;
      return diagnostics_.add(member.position, member_path, unknown_key(member.key, shape));
    }
    if (!known->refusal.empty())
      return fail(member.value, member_path, fmt::format("{}; {}", known->refusal, instead_of(member.key, shape)));
    check(member.value, known->shape, member_path, in_words(known->shape));
  }

  /// What to write in the place of a key that is refused.
  static std::string instead_of(const std::string& name, const Shape& shape) {
    for (const Exclusive& group : shape.exclusive)
      if (group.required && std::find(group.keys.begin(), group.keys.end(), name) != group.keys.end())
        return "must be " + join_or(supported_of(group, shape));
    return "remove it";
  }

  static std::vector<std::string> supported_of(const Exclusive& group, const Shape& shape) {
    std::vector<std::string> names;
    for (const std::string& name : group.keys)
      if (shape.find(name)->refusal.empty()) names.push_back(name);
    return names;
  }

  std::string unknown_key(const std::string& name, const Shape& shape) const {
    if (diagnostics_.is_full()) return "is no known key";
    const std::vector<std::string> known = supported_keys(shape);
    const std::string near = nearest(name, known);
    if (!near.empty()) return fmt::format("is no known key; did you mean \"{}\"?", near);
    return known.empty() ? "is no known key; remove it"
                         : fmt::format("is no known key; known here: {}", fmt::join(known, ", "));
  }

  void check_exclusive(const Value& value, const Shape& shape, const Exclusive& group, const std::string& path) {
    std::vector<const Member*> given;
    for (const Member& member : *value.as_table())
      if (std::find(group.keys.begin(), group.keys.end(), member.key) != group.keys.end()) given.push_back(&member);
    if (given.empty() && group.required && !(group.unless_needed && needed_))
      return diagnostics_.add(value.position, path,
                              fmt::format("{} is missing; give exactly one", join_or(supported_of(group, shape))));
    for (std::size_t i = 1; i < given.size(); ++i)
      diagnostics_.add(given[i]->value.position, join(path, given[i]->key),
                       fmt::format("cannot stand beside {}; give only one of them", given.front()->key));
  }

  Diagnostics& diagnostics_;
  /// The named table that was begun last, as a body is.
  struct Named {
    std::string path, key;
    const Table* among = nullptr;
  };
  Named named_;
  bool needed_;
  int depth_ = 0;
};

}  // namespace

void validate(Value& document, const Shape& schema, Diagnostics& diagnostics) {
  Validator(diagnostics, states_need(document)).check(document, schema, "", in_words(schema));
}

}  // namespace fascia::app
