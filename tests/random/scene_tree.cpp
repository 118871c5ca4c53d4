#include "tests/random/scene_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace fascia::random_scenes {
namespace {

using app::Shape;
using app::Type;

bool fits(const Json& value, const Shape& shape) {
  switch (shape.type) {
    case Type::number:
    case Type::integer:
      return value.is_number();
    case Type::boolean:
      return value.is_boolean();
    case Type::text:
      return value.is_string();
    case Type::choice:
      return value.is_string() && std::any_of(shape.choices.begin(), shape.choices.end(),
                                              [&](const app::Choice& c) { return c.value == value; });
    case Type::array:
      return value.is_array() && (value.empty() || fits(value[0], shape.items[0]));
    case Type::tuple:
      return value.is_array() && (value.empty() || fits(value[0], shape.items[0]));
    case Type::table:
    case Type::named_tables:
      return value.is_object();
    case Type::one_of:
      return std::any_of(shape.items.begin(), shape.items.end(), [&](const Shape& s) { return fits(value, s); });
    case Type::reference:
      return fits(value, shape.target());
    case Type::anything:
      return true;
  }
  return false;
}

/// Null where no alternative fits.
const Shape* resolved(const Json& value, const Shape* shape) {
  while (shape != nullptr && (shape->type == Type::reference || shape->type == Type::one_of)) {
    if (shape->type == Type::reference) {
      shape = &shape->target();
      continue;
    }
    const auto found =
        std::find_if(shape->items.begin(), shape->items.end(), [&](const Shape& s) { return fits(value, s); });
    shape = found == shape->items.end() ? nullptr : &*found;
  }
  return shape;
}

void walk(Place& at, const std::function<bool(const Place&)>& look) {
  if (!look(at)) return;
  Json& value = *at.value;
  const auto enter = [&](Json& child, const Shape* shape, const std::string& key) {
    Place below{&child, resolved(child, shape), at.path, at.above};
    if (below.shape == nullptr) return;
    below.path.push_back(key);
    below.above.push_back(&value);
    walk(below, look);
  };
  if (value.is_object()) {
    for (auto& [key, child] : value.items()) {
      const app::Key* known = at.shape->find(key);
      if (at.shape->type == Type::named_tables)
        enter(child, &at.shape->items[0], key);
      else if (known != nullptr)
        enter(child, &known->shape, key);
    }
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      const std::size_t item = at.shape->type == Type::tuple ? std::min(i, at.shape->items.size() - 1) : 0;
      enter(value[i], &at.shape->items[item], std::to_string(i));
    }
  }
}

const Shape* below(const Shape& shape, const std::string& key) {
  switch (shape.type) {
    case Type::reference:
      return below(shape.target(), key);
    case Type::one_of:
      for (const Shape& s : shape.items)
        if (const Shape* found = below(s, key)) return found;
      return nullptr;
    case Type::table: {
      const app::Key* found = shape.find(key);
      return found == nullptr ? nullptr : &found->shape;
    }
    case Type::named_tables:
    case Type::array:
      return key == "*" ? &shape.items[0] : nullptr;
    default:
      return nullptr;
  }
}

std::string inline_text(const Json& value) {
  if (value.is_number_float()) return fmt::format("{:.17g}", value.get<double>());
  if (value.is_array()) {
    std::string text;
    for (const Json& item : value) text += (text.empty() ? "" : ", ") + inline_text(item);
    return "[" + text + "]";
  }
  if (value.is_object()) {
    std::string text;
    for (const auto& [key, item] : value.items()) text += (text.empty() ? "" : ", ") + key + " = " + inline_text(item);
    return "{ " + text + " }";
  }
  return value.dump();
}

}  // namespace

void visit(Json& scene, const std::function<bool(const Place&)>& look) {
  Place root{&scene, &app::scene_schema(), {}, {}};
  walk(root, look);
}

const Shape& shape_at(std::string_view path) {
  const Shape* shape = &app::scene_schema();
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    shape = below(*shape, std::string(path.substr(begin, end - begin)));
    if (shape == nullptr) throw std::out_of_range("the schema has no " + std::string(path));
    begin = end + 1;
  }
  return *shape;
}

bool is_vector(const Shape& shape) {
  return shape.type == Type::array && shape.min_items == 3 && shape.max_items == 3 &&
         shape.items[0].type == Type::number;
}

SceneText text_of(const Json& scene) {
  SceneText out;
  int line = 0;
  const auto add = [&](const std::string& text) { out.text += text + "\n", ++line; };
  const auto table = [&](const std::string& head, const std::string& path, const Json& keys) {
    add(head);
    out.lines[path] = line;
    for (const auto& [key, value] : keys.items()) {
      add(key + " = " + inline_text(value));
      out.lines[path + "." + key] = line;
    }
  };
  for (const auto& [section, value] : scene.items()) {
    if (value.is_array()) {
      for (std::size_t i = 0; i < value.size(); ++i)
        table("[[" + section + "]]", fmt::format("{}[{}]", section, i), value[i]);
    } else if (shape_at(section).type == Type::named_tables) {
      for (const auto& [name, keys] : value.items())
        table(fmt::format("[{}.{}]", section, name), section + "." + name, keys);
    } else {
      table("[" + section + "]", section, value);
    }
  }
  return out;
}

std::string Draws::word(std::string_view path) {
  const std::function<std::vector<std::string>(const Shape&)> words = [&](const Shape& shape) {
    std::vector<std::string> all;
    if (shape.type == Type::choice) all = app::supported_values(shape);
    for (const Shape& item : shape.type == Type::one_of ? shape.items : std::vector<Shape>{})
      for (const std::string& w : words(item)) all.push_back(w);
    return all;
  };
  return pick(words(shape_at(path)));
}

}  // namespace fascia::random_scenes
