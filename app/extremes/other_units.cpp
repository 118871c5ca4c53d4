#include "app/extremes/other_units.hpp"

#include "app/reader/overrides.hpp"
#include "app/scene/diagnostics.hpp"
#include "app/scene/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <stdexcept>
#include <string>

namespace fascia::app {
namespace {

/// Exponents of mass, length and time.
struct Symbol {
  std::string_view name;
  int mass, length, time;
};
constexpr std::array kSymbols{Symbol{"1", 0, 0, 0},   Symbol{"rad", 0, 0, 0},  Symbol{"byte", 0, 0, 0},
                              Symbol{"kg", 1, 0, 0},  Symbol{"m", 0, 1, 0},    Symbol{"s", 0, 0, 1},
                              Symbol{"N", 1, 1, -2},  Symbol{"Pa", 1, -1, -2}, Symbol{"J", 1, 2, -2},
                              Symbol{"Hz", 0, 0, -1}, Symbol{"W", 1, 2, -3}};

const Shape& resolved(const Shape& shape) { return shape.type == Type::reference ? resolved(shape.target()) : shape; }

const Shape* alternative_for(const Value& value, const Shape& shape);

/// A value of this shape has numbers with units, here or in a list in it.
bool is_written_by(const Value& value, const Shape& given) {
  const Shape& shape = resolved(given);
  const Array* items = value.as_array();
  switch (shape.type) {
    case Type::one_of:
      return alternative_for(value, shape) != nullptr;
    case Type::number: {
      const std::string* text = value.as_string();
      return number_in(value) || (text != nullptr && parse_quantity(*text, shape.unit).index() == 0);
    }
    case Type::array:
      return items != nullptr &&
             std::ranges::any_of(*items, [&](const Value& item) { return is_written_by(item, shape.items.front()); });
    case Type::tuple:
      for (std::size_t i = 0; items != nullptr && i < std::min(items->size(), shape.items.size()); ++i)
        if (is_written_by((*items)[i], shape.items[i])) return true;
      return false;
    case Type::table:
    case Type::named_tables:
      return value.as_table() != nullptr;
    default:
      return false;
  }
}

/// The alternative that a value is written by; null where none of them has numbers with units.
const Shape* alternative_for(const Value& value, const Shape& shape) {
  const auto found = std::ranges::find_if(shape.items, [&](const Shape& item) { return is_written_by(value, item); });
  return found == shape.items.end() ? nullptr : &resolved(*found);
}

class Walk {
 public:
  explicit Walk(const std::function<double(std::string_view, std::string_view)>& factor) : factor_(factor) {}

  void visit(Value& value, const Shape& given, const std::string& path) const {
    const Shape& shape = resolved(given);
    switch (shape.type) {
      case Type::number:
        multiply(value, shape, path);
        break;
      case Type::one_of:
        if (const Shape* chosen = alternative_for(value, shape)) visit(value, *chosen, path);
        break;
      case Type::array:
        if (Array* items = value.as_array())
          for (std::size_t i = 0; i < items->size(); ++i) visit((*items)[i], shape.items.front(), join(path, i));
        break;
      case Type::tuple:
        if (Array* items = value.as_array())
          for (std::size_t i = 0; i < std::min(items->size(), shape.items.size()); ++i)
            visit((*items)[i], shape.items[i], join(path, i));
        break;
      case Type::named_tables:
        if (Table* members = value.as_table())
          for (Member& m : *members) visit(m.value, shape.items.front(), join(path, m.key));
        break;
      case Type::table:
        if (Table* members = value.as_table())
          for (Member& m : *members)
            if (const Key* key = shape.find(m.key)) visit(m.value, key->shape, join(path, m.key));
        break;
      default:
        break;  // words and whole numbers have no unit
    }
  }

 private:
  void multiply(Value& value, const Shape& shape, const std::string& path) const {
    const double factor = factor_(shape.unit, path);
    if (factor == 1) return;
    if (const std::optional<double> number = number_in(value))
      value.data = *number * factor;
    else if (const std::string* text = value.as_string())
      if (const auto read = parse_quantity(*text, shape.unit); const double* quantity = std::get_if<double>(&read))
        value.data = *quantity * factor;
  }

  const std::function<double(std::string_view, std::string_view)>& factor_;
};

/// True where a table of this document has a key.
bool has(const Value& table, std::string_view key) { return table.find(key) != nullptr; }

/// A mesh's own numbers stand in a file: the transform of the body makes up for them.
void enlarge_file(Value& body, double length) {
  const Value* transform = body.find("transform");
  const Value* scale = transform != nullptr ? transform->find("scale") : nullptr;
  Diagnostics none("");
  const double old = scale != nullptr ? number_in(*scale).value_or(1) : 1;
  apply_override(body, fmt::format("transform.scale={:.17g}", length * old), none);
}

/// Numbers of other files, or of the clock on the wall.
bool reaches_all(const Value& scene) {
  if (has(scene, "need")) return false;
  const Value* bodies = scene.find("bodies");
  if (bodies == nullptr || bodies->as_table() == nullptr) return true;
  return std::none_of(bodies->as_table()->begin(), bodies->as_table()->end(), [](const Member& body) {
    const Value* frames = body.value.find("frames");
    const Value* points = body.value.find("points");
    return has(body.value, "need") || (frames != nullptr && has(*frames, "file")) ||
           (points != nullptr && has(*points, "file"));
  });
}

}  // namespace

double UnitFactors::of(std::string_view si_unit) const {
  double factor = 1;
  int sign = 1;
  for (std::size_t i = 0; i < si_unit.size();) {
    if (si_unit[i] == ' ' || si_unit[i] == '/') {
      sign = si_unit[i++] == '/' ? -1 : 1;
      continue;
    }
    std::size_t end = i + 1;  // of the symbol: letters, or the figure 1
    while (end < si_unit.size() && std::isalpha(static_cast<unsigned char>(si_unit[end])) != 0) ++end;
    const std::string_view name = si_unit.substr(i, end - i);
    int power = sign;
    if (end < si_unit.size() && std::isdigit(static_cast<unsigned char>(si_unit[end])) != 0)
      power *= si_unit[end++] - '0';
    const auto* symbol =
        std::find_if(kSymbols.begin(), kSymbols.end(), [&](const Symbol& s) { return s.name == name; });
    if (symbol == kSymbols.end()) throw std::invalid_argument("no dimension is known of " + std::string(si_unit));
    factor *= std::pow(mass, power * symbol->mass) * std::pow(length, power * symbol->length) *
              std::pow(time, power * symbol->time);
    i = end;
  }
  return factor;
}

std::optional<double> number_in(const Value& value) {
  if (const double* number = std::get_if<double>(&value.data)) return *number;
  if (const std::int64_t* whole = std::get_if<std::int64_t>(&value.data)) return static_cast<double>(*whole);
  return std::nullopt;
}

void scale_numbers(Value& value, const Shape& shape,
                   const std::function<double(std::string_view, std::string_view)>& factor) {
  Walk(factor).visit(value, shape, "");
}

bool change_units(Value& scene, const UnitFactors& factors) {
  if (!reaches_all(scene)) return false;
  scale_numbers(scene, scene_schema(), [&](std::string_view unit, std::string_view) { return factors.of(unit); });
  if (Value* bodies = scene.find("bodies"); bodies != nullptr && bodies->as_table() != nullptr)
    for (Member& body : *bodies->as_table())
      if (const Value* domain = body.value.find("domain"); domain != nullptr && has(*domain, "file"))
        enlarge_file(body.value, factors.length);
  return true;
}

}  // namespace fascia::app
