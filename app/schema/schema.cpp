#include "app/schema/schema.hpp"

#include "app/scene/diagnostics.hpp"
#include "app/scene/units.hpp"
#include "app/scene/warning_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

Shape of_type(Type type) {
  Shape shape;
  shape.type = type;
  return shape;
}

std::string with_range(const std::string& noun, const Range& range) {
  return range.is_everything() ? noun : noun + " " + range.text();
}

std::string list_in_words(const Shape& shape) {
  if (shape.type == Type::tuple) {
    std::string parts;
    for (const Shape& item : shape.items) parts += (parts.empty() ? "" : ", ") + in_words(item);
    return fmt::format("[{}]", parts);
  }
  const std::string item = in_words(shape.items.front());
  if (shape.min_items == shape.max_items) return fmt::format("a list of {}, each {}", shape.min_items, item);
  if (shape.is_bounded()) return fmt::format("a list of {} to {}, each {}", shape.min_items, shape.max_items, item);
  return fmt::format("a list, each {}", item);
}

std::string table_in_words(const Shape& shape) {
  for (const Exclusive& group : shape.exclusive) {
    std::vector<std::string> keys;
    for (const std::string& name : group.keys)
      if (shape.find(name)->refusal.empty()) keys.push_back(name);
    if (group.required) return "a table with " + join_or(keys);
  }
  std::vector<std::string> needed;
  for (const Key& k : shape.keys)
    if (k.required) needed.push_back(k.name);
  return needed.empty() ? "a table" : fmt::format("a table with {}", fmt::join(needed, ", "));
}

std::string alternatives_in_words(const Shape& shape) {
  std::vector<std::string> parts;
  for (const Shape& item : shape.items)
    if (item.type != Type::choice || !supported_values(item).empty()) parts.push_back(in_words(item));
  return join_or(parts);
}

std::string values_in_words(const Shape& shape) {
  std::vector<std::string> values = supported_values(shape);
  for (std::string& value : values) value = in_quotes(value);
  return join_or(values);
}

}  // namespace

bool Range::contains(double value) const {
  return (min_excluded ? value > min : value >= min) && (max_excluded ? value < max : value <= max);
}

bool Range::is_everything() const { return std::isinf(min) && std::isinf(max); }

std::string Range::text() const {
  std::string low = fmt::format("{} {}", min_excluded ? "above" : "at least", min);
  std::string high = fmt::format("{} {}", max_excluded ? "below" : "at most", max);
  if (is_everything()) return "";
  if (std::isinf(max)) return low;
  if (std::isinf(min)) return high;
  return min_excluded || max_excluded ? low + " and " + high : fmt::format("from {} to {}", min, max);
}

Range above(double min) { return {.min = min, .min_excluded = true}; }
Range at_least(double min) { return {.min = min}; }
Range between(double min, double max) { return {.min = min, .max = max}; }
Range inside(double min, double max) { return {.min = min, .max = max, .min_excluded = true, .max_excluded = true}; }

const Key* Shape::find(std::string_view key) const {
  const auto found = std::find_if(keys.begin(), keys.end(), [&](const Key& k) { return k.name == key; });
  return found == keys.end() ? nullptr : &*found;
}

Key Key::needed() const {
  Key copy = *this;
  copy.required = true;
  return copy;
}

Key Key::defaults(std::string text) const {
  Key copy = *this;
  copy.default_text = std::move(text);
  return copy;
}

Key Key::refused(std::string why) const {
  Key copy = *this;
  copy.refusal = std::move(why);
  return copy;
}

Shape number(std::string unit, Range range) {
  Shape shape = of_type(Type::number);
  shape.unit = std::move(unit);
  shape.range = range;
  return shape;
}

Shape integer(Range range) {
  Shape shape = of_type(Type::integer);
  shape.range = range;
  return shape;
}

Shape text(std::string in_words) {
  Shape shape = of_type(Type::text);
  shape.name = std::move(in_words);
  return shape;
}

Shape text_of_lines(std::string in_words) {
  Shape shape = text(std::move(in_words));
  shape.of_lines = true;
  return shape;
}

Shape boolean() { return of_type(Type::boolean); }

Shape choice(std::vector<Choice> choices) {
  Shape shape = of_type(Type::choice);
  shape.choices = std::move(choices);
  return shape;
}

Shape array(Shape item, std::size_t min_items, std::size_t max_items) {
  Shape shape = of_type(Type::array);
  shape.items = {std::move(item)};
  shape.min_items = min_items;
  shape.max_items = max_items;
  return shape;
}

Shape tuple(std::vector<Shape> items) {
  Shape shape = of_type(Type::tuple);
  shape.items = std::move(items);
  shape.min_items = shape.max_items = shape.items.size();
  return shape;
}

Shape vector3(const std::string& unit, Range range) { return array(number(unit, range), 3, 3); }

Shape table(std::vector<Key> keys, std::vector<Exclusive> exclusive, std::string selector) {
  Shape shape = of_type(Type::table);
  shape.keys = std::move(keys);
  shape.exclusive = std::move(exclusive);
  shape.selector = std::move(selector);
  return shape;
}

Shape named_tables(Shape item, bool plain_names, std::size_t min_items) {
  Shape shape = of_type(Type::named_tables);
  shape.plain_names = plain_names;
  shape.items = {std::move(item)};
  shape.min_items = min_items;
  return shape;
}

Shape one_of(std::vector<Shape> alternatives) {
  Shape shape = of_type(Type::one_of);
  shape.items = std::move(alternatives);
  return shape;
}

Shape reference(std::string name, const Shape& (*target)()) {
  Shape shape = of_type(Type::reference);
  shape.name = std::move(name);
  shape.target = target;
  return shape;
}

Shape anything(std::string in_words) {
  Shape shape = of_type(Type::anything);
  shape.name = std::move(in_words);
  return shape;
}

Key key(std::string name, Shape shape, std::string doc) {
  Key result;
  result.name = std::move(name);
  result.shape = std::move(shape);
  result.doc = std::move(doc);
  return result;
}

Key later(std::string name, std::string doc) {
  return key(std::move(name), anything("a value"), std::move(doc)).not_yet();
}

const Shape& scene_schema() {
  static const Shape scene =
      table({key("title", text(), "One line for people.").defaults("empty"),
             key("silence", array(choice(warning_names())),
                 "Warnings that are not told, by the name in brackets at their end.")
                 .defaults("[]"),
             world_schema(), materials_schema(), bodies_schema(), constraints_schema(), loads_schema(),
             couplings_schema(), solver_schema(), probes_schema(), output_schema(), need_schema(),
             later("initial", "Another result of the same bodies that the run starts from."),
             later("phases", "Parts of a run with loads, constraints and a solver of their own."),
             later("contacts", "Contact between bodies."), later("tools", "Instruments that touch bodies.")});
  return scene;
}

std::string in_words(const Shape& shape) {
  switch (shape.type) {
    case Type::number:
      return with_range(dimension_in_words(shape.unit), shape.range);
    case Type::integer:
      return with_range("a whole number", shape.range);
    case Type::text:
    case Type::anything:
      return shape.name;
    case Type::boolean:
      return "true or false";
    case Type::choice:
      return values_in_words(shape);
    case Type::array:
    case Type::tuple:
      return list_in_words(shape);
    case Type::table:
      return table_in_words(shape);
    case Type::named_tables:
      return "tables with names";
    case Type::one_of:
      return alternatives_in_words(shape);
    case Type::reference:
      return in_words(shape.target());
  }
  return "";
}

std::vector<std::string> supported_keys(const Shape& shape) {
  std::vector<std::string> names;
  for (const Key& k : shape.keys)
    if (k.refusal.empty()) names.push_back(k.name);
  return names;
}

std::vector<std::string> supported_values(const Shape& shape) {
  std::vector<std::string> values;
  for (const Choice& c : shape.choices)
    if (c.supported) values.push_back(c.value);
  return values;
}

}  // namespace fascia::app
