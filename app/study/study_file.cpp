#include "app/study/study_file.hpp"

#include "app/reader/table_reader.hpp"
#include "app/reader/text_checks.hpp"
#include "app/reader/validate.hpp"
#include "app/scene/toml_text.hpp"
#include "app/scene/units.hpp"
#include "app/study/study_schema.hpp"
#include "core/base/errors.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// The last part of a key's path: "bodies.beam.frames.grid" → "grid".
std::string last_part(const std::string& key) {
  const std::size_t dot = key.find_last_of('.');
  return dot == std::string::npos ? key : key.substr(dot + 1);
}

/// A value as a label: texts without quotes.
std::string label_of(const Value& value) {
  const std::string* text = value.as_string();
  return text ? *text : toml_text(value);
}

/// A number, or a quantity whose unit is one that scenes know, in SI.
std::optional<double> number_of(const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value.data)) return static_cast<double>(*whole);
  if (const auto* number = std::get_if<double>(&value.data)) return *number;
  if (const std::string* text = value.as_string())
    for (const UnitExamples& unit : unit_examples()) {
      const auto result = parse_quantity(*text, unit.unit);
      if (const double* number = std::get_if<double>(&result)) return *number;
    }
  return std::nullopt;
}

/// "key.path=value" of every key of a table of changes. Tables under bare keys are gone into, those under a quoted
/// path with dots are values.
void add_changes(const Value& changes, const std::string& path, std::vector<std::string>& overrides) {
  for (const Member& member : *changes.as_table()) {
    const bool whole = member.key.find_first_of(".[") != std::string::npos;
    const std::string key = (path.empty() ? "" : path + ".") + (whole ? member.key : toml_key(member.key));
    if (!whole && member.value.as_table() != nullptr)
      add_changes(member.value, key, overrides);
    else
      overrides.push_back(key + "=" + toml_text(member.value));
  }
}

std::vector<std::string> changes_of(const TableReader& table, const char* key) {
  std::vector<std::string> overrides;
  const Value* changes = table.value(key);
  if (changes == nullptr) return overrides;
  if (changes->as_table() == nullptr)
    table.error(key, fmt::format("{} is of the wrong type; must be a table of keys and values", describe(*changes)));
  else
    add_changes(*changes, "", overrides);
  return overrides;
}

std::vector<std::string> texts_of(const TableReader& table, const char* key) {
  std::vector<std::string> texts;
  if (const Value* list = table.value(key))
    for (const Value& item : *list->as_array())
      if (const std::string* text = item.as_string()) texts.push_back(*text);
  return texts;
}

/// Rows of values for keys that are moved together.
void read_rows(const TableReader& table, StudyAxis& axis) {
  const Value* values = table.value("values");
  if (values == nullptr) return table.error("values", "is missing; must be a list of values for the key");
  for (const Value& value : *values->as_array()) {
    AxisValue& entry = axis.values.emplace_back();
    if (axis.keys.size() == 1 && !table.has("keys")) {
      entry.label = label_of(value);
      entry.overrides.push_back(axis.keys[0] + "=" + toml_text(value));
      entry.number = number_of(value);
      continue;
    }
    const Array* row = value.as_array();
    if (row == nullptr || row->size() != axis.keys.size()) {
      table.error("values", fmt::format("{} does not fit `keys`; each row must have {} values", describe(value),
                                        axis.keys.size()));
      return;
    }
    for (std::size_t k = 0; k < row->size(); ++k) {
      entry.label += (k == 0 ? "" : ", ") + label_of((*row)[k]);
      entry.overrides.push_back(axis.keys[k] + "=" + toml_text((*row)[k]));
    }
    entry.number = number_of(row->front());
  }
}

void read_alternatives(const TableReader& table, StudyAxis& axis) {
  for (const TableReader& alternative : table.tables("alternatives")) {
    AxisValue& entry = axis.values.emplace_back();
    entry.label = alternative.text("name").value_or("");
    for (const std::string& key : texts_of(alternative, "remove")) entry.overrides.push_back(key + "=");
    for (std::string& change : changes_of(alternative, "set")) entry.overrides.push_back(std::move(change));
  }
}

void read_refinements(const TableReader& table, StudyAxis& axis) {
  for (const Value& value : *table.value("refine")->as_array()) {
    AxisValue& entry = axis.values.emplace_back();
    entry.refine = std::get<double>(value.data);
    entry.label = fmt::format("{:g}", entry.refine);
    entry.number = entry.refine;
  }
}

StudyAxis read_axis(const TableReader& table) {
  StudyAxis axis;
  axis.place = table.place();
  axis.body = table.text("body").value_or("");
  if (const auto key = table.text("key")) axis.keys = {*key};
  if (table.has("keys")) axis.keys = texts_of(table, "keys");
  if (!axis.keys.empty()) read_rows(table, axis);
  if (table.has("alternatives")) read_alternatives(table, axis);
  for (const std::string& word : texts_of(table, "models")) axis.values.push_back({word, {}, {}, word, 1});
  if (table.has("models") && axis.body.empty())
    table.error("body", "is missing; must be the name of the body whose models are compared");
  if (table.value("refine") != nullptr) read_refinements(table, axis);
  std::string name = table.has("models")         ? "model"
                     : table.has("alternatives") ? "alternative"
                     : table.has("refine")       ? "refine"
                                                 : "";
  for (const std::string& key : axis.keys) name += (name.empty() ? "" : ",") + last_part(key);
  axis.name = table.text("name").value_or(name);
  return axis;
}

StudyReference read_reference(const TableReader& owner) {
  StudyReference reference;
  reference.place = owner.place("reference");
  const Value* given = owner.value("reference");
  if (given == nullptr) return reference;
  if (given->as_string() != nullptr) {
    reference.kind = StudyReference::Kind::finest;
    return reference;
  }
  const TableReader table = owner.table("reference");
  reference.overrides = changes_of(table, "set");
  if (const auto scene = table.text("scene")) reference.scene = *scene;
  if (!table.has("value")) {
    reference.kind = StudyReference::Kind::scene;
    if (!table.has("scene") && !table.has("set"))
      table.error("needs `value`, `scene` or `set`; or write reference = \"finest\"");
    return reference;
  }
  reference.kind = StudyReference::Kind::value;
  reference.source = table.text("source").value_or("");
  if (reference.source.empty()) table.error("source", "is missing; must say where the value is from");
  if (!table.has("uncertainty"))
    table.error("uncertainty", "is missing; must be that of the value, relative: 1e-3, or 0 where it is exact");
  reference.uncertainty = table.number("uncertainty").value_or(0);
  if (table.has("scene") || table.has("set")) table.error("cannot have a value beside `scene` or `set`; remove one");
  const Value* value = table.value("value");
  if (value == nullptr) return reference;
  const Array single{*value};
  for (const Value& item : value->as_array() != nullptr ? *value->as_array() : single) {
    const std::string* text = item.as_string();
    if (text == nullptr && !number_of(item))
      table.error("value",
                  fmt::format("{} is of the wrong type; must be a number, a quantity with a unit, or a list of "
                              "these",
                              describe(item)));
    reference.quantities.push_back(text != nullptr ? *text : "");
    reference.value.push_back(text != nullptr ? 0 : number_of(item).value_or(0));
  }
  return reference;
}

void check_field(const TableReader& table, const StudyMeasure& measure) {
  table.refuse({"component", "moment"}, "belongs to a probe; a field is compared as a whole, at the end");
  if (measure.reference.kind == StudyReference::Kind::none)
    table.error(
        "reference",
        "is missing; a field needs one, which may be \"finest\", { scene = \"FILE\" } or { set = { KEY = VALUE } }");
  if (measure.reference.kind == StudyReference::Kind::value)
    table.error("reference",
                "is a value, and a field needs another field; use \"finest\", { scene = \"FILE\" } or { set = { KEY = "
                "VALUE } }, or measure a probe");
}

StudyMeasure read_measure(const TableReader& table, const Study& study) {
  const fs::path folder = study.path.parent_path();
  StudyMeasure measure;
  measure.place = table.place();
  measure.probe = table.text("probe").value_or("");
  measure.field = table.text("field").value_or("");
  measure.body = table.text("body").value_or("");
  measure.name = table.text("name").value_or(measure.probe + measure.field);
  if (const Value* component = table.value("component")) {
    if (const std::string* letter = component->as_string())
      measure.entry = {static_cast<std::size_t>((*letter)[0] - 'x')};
    if (const auto* index = std::get_if<std::int64_t>(&component->data))
      measure.entry = {static_cast<std::size_t>(*index)};
    if (const Array* indices = component->as_array())
      for (const Value& index : *indices)
        measure.entry.push_back(static_cast<std::size_t>(std::get<std::int64_t>(index.data)));
  }
  const std::string moment = table.text("moment").value_or("end");
  measure.moment = moment == "largest" ? Moment::largest : moment == "curve" ? Moment::curve : Moment::end;
  if (const auto per = table.text("per")) {
    std::vector<std::string> known;
    for (std::size_t a = 0; a < study.axes.size(); ++a) {
      known.push_back(study.axes[a].name);
      if (known.back() == *per) measure.per = a;
    }
    if (!measure.per) table.error("per", unknown_name("axis", *per, known));
  }
  measure.reference = read_reference(table);
  if (!measure.reference.scene.empty()) measure.reference.scene = folder / measure.reference.scene;
  if (measure.moment == Moment::curve && measure.reference.kind == StudyReference::Kind::value)
    table.error("reference", "is one value, and `moment` asks for a curve; use a scene or \"finest\"");
  if (measure.field.empty())
    table.refuse({"body"}, "belongs to a field, and this measure is of a probe, which has its body");
  else
    check_field(table, measure);
  return measure;
}

void check_names(const Study& study, Diagnostics& diagnostics) {
  std::set<std::string> axes, measures;
  for (const StudyAxis& axis : study.axes)
    if (!axes.insert(axis.name).second)
      diagnostics.add(axis.place, fmt::format("the name {} stands twice; give `name`", in_quotes(axis.name)));
  for (const StudyMeasure& measure : study.measures)
    if (!measures.insert(measure.name).second)
      diagnostics.add(measure.place, fmt::format("the name {} stands twice; give `name`", in_quotes(measure.name)));
  const auto length = [](const StudyAxis& axis) { return axis.values.size(); };
  if (study.mode == StudyMode::paired)
    for (const StudyAxis& axis : study.axes)
      if (length(axis) != length(study.axes.front()))
        diagnostics.add(axis.place, fmt::format("has {} values and the first axis {}; paired axes have as many",
                                                length(axis), length(study.axes.front())));
}

Value parsed(const fs::path& path, Diagnostics& diagnostics) {
  try {
    return parse_toml(io::read_file(path));
  } catch (const SyntaxError& e) {
    diagnostics.add(e.position, "toml", one_line(e.message) + (e.remedy.empty() ? "" : "; " + e.remedy));
  }
  diagnostics.throw_if_any();
  return {};
}

}  // namespace

Study read_study(const fs::path& path) {
  Diagnostics diagnostics(path.string());
  Value document = parsed(path, diagnostics);
  if (document.find("base") == nullptr && (document.find("bodies") != nullptr || document.find("solver") != nullptr))
    diagnostics.add(
        Position{}, "base",
        "is missing, and this is a scene; write a study with base = \"SCENE\", or use --vary and --measure");
  diagnostics.throw_if_any();
  validate(document, study_schema(), diagnostics);
  diagnostics.throw_if_any();
  const TableReader table(&document, "", diagnostics);
  Study study;
  study.path = path;
  study.title = table.text("title").value_or("");
  study.base = path.parent_path() / table.text("base").value_or("");
  for (const std::string& key : texts_of(table, "remove")) study.overrides.push_back(key + "=");
  for (std::string& change : changes_of(table, "set")) study.overrides.push_back(std::move(change));
  for (const TableReader& axis : table.tables("axes")) study.axes.push_back(read_axis(axis));
  for (const TableReader& measure : table.tables("measures")) study.measures.push_back(read_measure(measure, study));
  const std::string mode = table.text("mode").value_or("all"), cost = table.text("cost").value_or("");
  study.mode = mode == "paired" ? StudyMode::paired : mode == "front" ? StudyMode::front : StudyMode::all;
  if (!cost.empty())
    study.cost = cost == "step" ? StudyCost::step : cost == "total" ? StudyCost::total : StudyCost::solve;
  study.dimension = table.integer("dimension");
  study.need = table.number("need");
  study.repeat = table.integer("repeat").value_or(study.repeat);
  study.warm_up = table.integer("warm_up").value_or(study.warm_up);
  study.timed = table.boolean("timed").value_or(true);
  study.time_limit = table.number("time_limit").value_or(0);
  for (const auto& [key, list] : {std::pair{"budgets", &study.budgets}, std::pair{"sizes", &study.sizes}})
    if (const Value* values = table.value(key))
      for (const Value& value : *values->as_array()) list->push_back(std::get<double>(value.data));
  check_names(study, diagnostics);
  diagnostics.throw_if_any();
  return study;
}

Study study_of(const fs::path& scene, const std::vector<std::string>& vary, const std::vector<std::string>& measures) {
  Diagnostics diagnostics(scene.string());
  Study study;
  study.path = study.base = scene;
  for (const std::string& text : vary) {
    const Place place{"--vary", 1, 1, text};
    StudyAxis& axis = study.axes.emplace_back();
    axis.place = place;
    const std::size_t equals = text.find('=');
    try {
      const Value document = parse_toml("v = " + (equals == std::string::npos ? "" : text.substr(equals + 1)));
      const Array* values = document.find("v")->as_array();
      if (values == nullptr || values->empty()) throw SyntaxError{};
      axis.keys = {text.substr(0, equals)};
      axis.name = last_part(axis.keys[0]);
      for (const Value& value : *values)
        axis.values.push_back({label_of(value), {axis.keys[0] + "=" + toml_text(value)}, number_of(value), "", 1});
    } catch (const SyntaxError&) {
      diagnostics.add(place, "is no key with a list of values; must be as in --vary 'solver.threads=[1, 2]'");
    }
  }
  for (const std::string& text : measures) {
    StudyMeasure& measure = study.measures.emplace_back();
    const bool component = text.size() > 2 && text[text.size() - 2] == '.' && text.back() >= 'x' && text.back() <= 'z';
    measure.place = Place{"--measure", 1, 1, text};
    measure.name = text;
    measure.probe = component ? text.substr(0, text.size() - 2) : text;
    if (component) measure.entry = {static_cast<std::size_t>(text.back() - 'x')};
    measure.reference.kind = StudyReference::Kind::finest;
    measure.reference.place = measure.place;
  }
  check_names(study, diagnostics);
  diagnostics.throw_if_any();
  return study;
}

}  // namespace fascia::app
