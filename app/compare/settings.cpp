#include "app/compare/settings.hpp"

#include "app/reader/overrides.hpp"
#include "app/scene/diagnostics.hpp"
#include "app/scene/document.hpp"
#include "app/scene/units.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

/// A quantity in SI, or the text itself.
std::string meaning_of(const std::string& text) {
  // Words and names, by far the most, begin otherwise.
  if (text.find_first_of("0123456789") > 1) return "\"" + text + "\"";
  for (const UnitExamples& kind : unit_examples()) {
    const auto value = parse_quantity(text, kind.unit);
    if (const double* number = std::get_if<double>(&value)) return fmt::format("{:.12g}", *number);
  }
  return "\"" + text + "\"";
}

std::string list_text(const std::vector<std::string>& items) { return fmt::format("[{}]", fmt::join(items, ", ")); }

/// A value on one line. @param meaning  quantities in SI
std::string text_of(const Value& value, bool meaning) {
  if (const std::string* text = value.as_string()) return meaning ? meaning_of(*text) : "\"" + one_line(*text) + "\"";
  if (const Array* items = value.as_array()) {
    std::vector<std::string> texts;
    for (const Value& item : *items) texts.push_back(text_of(item, meaning));
    return list_text(texts);
  }
  if (const Table* members = value.as_table()) {
    std::vector<std::string> texts;
    for (const Member& member : *members) texts.push_back(member.key + " = " + text_of(member.value, meaning));
    return fmt::format("{{ {} }}", fmt::join(texts, ", "));
  }
  if (const auto* number = std::get_if<double>(&value.data)) return fmt::format("{:.12g}", *number);
  if (const auto* whole = std::get_if<std::int64_t>(&value.data))
    return meaning ? fmt::format("{:.12g}", static_cast<double>(*whole)) : fmt::format("{}", *whole);
  if (const bool* flag = std::get_if<bool>(&value.data)) return *flag ? "true" : "false";
  return "a date";
}

bool is_list_of_tables(const Array& items) {
  return std::any_of(items.begin(), items.end(), [](const Value& item) { return item.as_table() != nullptr; });
}

void flatten(const Value& value, const std::string& path, std::vector<SceneSettings::Entry>& entries) {
  if (const Table* members = value.as_table()) {
    for (const Member& member : *members) flatten(member.value, join(path, member.key), entries);
    if (!members->empty()) return;
  }
  if (const Array* items = value.as_array(); items != nullptr && is_list_of_tables(*items)) {
    for (std::size_t i = 0; i < items->size(); ++i) flatten((*items)[i], join(path, i), entries);
    return;
  }
  if (!path.empty()) entries.push_back({path, text_of(value, false), text_of(value, true)});
}

const SceneSettings::Entry* find(const SceneSettings& settings, const std::string& key) {
  for (const SceneSettings::Entry& entry : settings.entries)
    if (entry.key == key) return &entry;
  return nullptr;
}

}  // namespace

std::string SceneSettings::value_of(const std::string& key) const {
  const Entry* entry = find(*this, key);
  if (entry == nullptr) return "";
  const std::string& text = entry->text;
  return text.size() > 1 && text.front() == '"' ? text.substr(1, text.size() - 2) : text;
}

SceneSettings scene_settings(const Json& summary, const std::string& name) {
  SceneSettings settings;
  const auto origin = summary.find("provenance");
  if (origin == summary.end() || !origin->is_object()) {
    settings.notes.push_back(
        fmt::format("settings: {} does not say where it came from (a version before 0.2 wrote it)", name));
    return settings;
  }
  try {
    Value document = parse_toml(origin->value("scene", ""));
    Diagnostics diagnostics(name);
    for (const Json& change : origin->value("overrides", Json::array()))
      apply_override(document, change.get<std::string>(), diagnostics);
    if (!diagnostics.empty())
      settings.notes.push_back(fmt::format("settings: an override of {} is not understood by this version", name));
    flatten(document, "", settings.entries);
  } catch (const SyntaxError& e) {
    settings.notes.push_back(fmt::format("settings: the scene that {} holds cannot be read: {}", name, e.message));
  }
  return settings;
}

std::vector<Difference> setting_differences(const SceneSettings& a, const SceneSettings& b) {
  std::vector<Difference> differences;
  for (const SceneSettings::Entry& entry : a.entries) {
    const SceneSettings::Entry* other = find(b, entry.key);
    if (other == nullptr || other->value != entry.value)
      differences.push_back({entry.key, entry.text, other == nullptr ? "" : other->text});
  }
  for (const SceneSettings::Entry& entry : b.entries)
    if (find(a, entry.key) == nullptr) differences.push_back({entry.key, "", entry.text});
  return differences;
}

std::vector<Difference> file_differences(const Json& a, const Json& b) {
  const auto digests = [](const Json& summary) {
    std::vector<std::pair<std::string, std::string>> files;
    const Json origin = summary.value("provenance", Json::object());
    for (const Json& file : origin.value("files", Json::array()))
      files.emplace_back(file.value("path", ""), file.value("sha256", ""));
    return files;
  };
  std::vector<Difference> differences;
  const auto of_b = digests(b);
  for (const auto& [path, digest] : digests(a))
    for (const auto& [other, there] : of_b)
      if (path == other && digest != there)
        differences.push_back({path, "SHA-256 " + digest.substr(0, 12), "SHA-256 " + there.substr(0, 12)});
  return differences;
}

}  // namespace fascia::app
