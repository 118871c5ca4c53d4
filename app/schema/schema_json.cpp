#include "app/scene/units.hpp"
#include "app/schema/schema.hpp"
#include "app/schema/schema_export.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

Json shape_as_json(const Shape& shape);

void add_range(Json& json, const Range& range) {
  if (!std::isinf(range.min)) json[range.min_excluded ? "exclusiveMinimum" : "minimum"] = range.min;
  if (!std::isinf(range.max)) json[range.max_excluded ? "exclusiveMaximum" : "maximum"] = range.max;
}

Json number_as_json(const Shape& shape) {
  Json number{{"type", "number"}};
  add_range(number, shape.range);
  const Json quantity{
      {"type", "string"}, {"pattern", "^\\s*[+-]?[0-9.].*[^0-9.\\s]"}, {"description", dimension_in_words(shape.unit)}};
  return {{"anyOf", Json::array({number, quantity})}};
}

Json integer_as_json(const Shape& shape) {
  Json json{{"type", "integer"}};
  json["minimum"] = static_cast<std::int64_t>(shape.range.min);
  json["maximum"] = static_cast<std::int64_t>(shape.range.max);
  return json;
}

Json array_as_json(const Shape& shape) {
  Json json{{"type", "array"}};
  if (shape.type == Type::tuple)
    for (const Shape& item : shape.items) json["prefixItems"].push_back(shape_as_json(item));
  else
    json["items"] = shape_as_json(shape.items.front());
  if (shape.min_items > 0) json["minItems"] = shape.min_items;
  if (shape.is_bounded()) json["maxItems"] = shape.max_items;
  return json;
}

/// "Exactly one of" or "at most one of", among the keys that this version takes.
Json exclusive_as_json(const Shape& table, const Exclusive& group) {
  Json one = Json::array(), any = Json::array();
  for (const std::string& name : group.keys)
    if (table.find(name)->refusal.empty()) any.push_back({{"required", {name}}});
  one = any;
  if (!group.required || group.unless_needed) one.push_back({{"not", {{"anyOf", any}}}});
  return {{"oneOf", one}};
}

Json table_as_json(const Shape& shape) {
  Json json{{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
  for (const Key& k : shape.keys) {
    if (!k.refusal.empty()) continue;
    Json property = shape_as_json(k.shape);
    property["description"] = k.default_text.empty() ? k.doc : k.doc + " Default: " + k.default_text + ".";
    json["properties"][k.name] = std::move(property);
    if (k.required) json["required"].push_back(k.name);
  }
  for (const Exclusive& group : shape.exclusive) json["allOf"].push_back(exclusive_as_json(shape, group));
  return json;
}

Json named_as_json(const Shape& shape) {
  Json json{{"type", "object"}, {"additionalProperties", shape_as_json(shape.items.front())}};
  if (shape.plain_names) json["propertyNames"] = {{"pattern", "^[A-Za-z0-9_-]+$"}};
  if (shape.min_items > 0) json["minProperties"] = shape.min_items;
  return json;
}

Json alternatives_as_json(const Shape& shape) {
  Json any = Json::array();
  for (const Shape& item : shape.items)
    if (item.type != Type::choice || !supported_values(item).empty()) any.push_back(shape_as_json(item));
  return {{"anyOf", any}};
}

Json shape_as_json(const Shape& shape) {
  switch (shape.type) {
    case Type::number:
      return number_as_json(shape);
    case Type::integer:
      return integer_as_json(shape);
    case Type::text:
      return {{"type", "string"}};
    case Type::boolean:
      return {{"type", "boolean"}};
    case Type::choice:
      return {{"enum", supported_values(shape)}};
    case Type::array:
    case Type::tuple:
      return array_as_json(shape);
    case Type::table:
      return table_as_json(shape);
    case Type::named_tables:
      return named_as_json(shape);
    case Type::one_of:
      return alternatives_as_json(shape);
    case Type::reference:
      return {{"$ref", "#/$defs/" + shape.name}};
    case Type::anything:
      return Json::object();
  }
  return {};
}

}  // namespace

std::string schema_as_json_schema() {
  Json json{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "fascia scene"}};
  json.update(shape_as_json(scene_schema()));
  json["$defs"]["material"] = shape_as_json(material_schema());
  json["$defs"]["region"] = shape_as_json(region_schema());
  json["$defs"]["profile"] = shape_as_json(profile_schema());
  return json.dump(1) + "\n";
}

}  // namespace fascia::app
