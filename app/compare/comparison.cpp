#include "app/compare/comparison.hpp"

#include "core/base/errors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>
#include <set>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// How sentences on probes begin that only one result has, from compare_results() and compare_probes().
constexpr const char* kOtherColumns = "probes.csv has other columns";

/// @param settings  of the result's scene; without them the summary tells dynamics
RunKind kind_of(const SceneSettings& settings, const Json& summary) {
  const std::string kind = settings.value_of("solver.kind"), control = settings.value_of("solver.control");
  if (kind == "modes") return RunKind::modes;
  if (kind.empty() ? summary.value("simulated_time", 0.0) > 0 : kind != "static") return RunKind::dynamics;
  return control.empty() || control == "load" ? RunKind::statics : RunKind::path;
}

std::map<std::string, double> volumes_of(const Json& summary) {
  std::map<std::string, double> volumes;
  const Json bodies = summary.value("bodies", Json::object());
  for (const auto& [name, body] : bodies.items()) volumes[name] = body.value("volume", 0.0);
  return volumes;
}

void append(std::vector<std::string>& sentences, const std::vector<std::string>& more) {
  for (const std::string& sentence : more)
    if (std::find(sentences.begin(), sentences.end(), sentence) == sentences.end()) sentences.push_back(sentence);
}

void tell_ends(const Json& x, const Json& y, Comparison& c) {
  const auto a = x.value("status", ""), b = y.value("status", "");
  if (a != b) c.structure.push_back(fmt::format("A ended as \"{}\", B as \"{}\"", a, b));
  for (const auto& [name, status] : {std::pair{"A", a}, std::pair{"B", b}})
    if (status == "running")
      c.structure.push_back(fmt::format("{} still runs, or was killed: what it has saved so far is compared", name));
}

/// Equal meshes and times are compared array by array, as `rerun` does it.
void use_arrays(Comparison& c) {
  const ResultDifference arrays = compare_results(c.a, c.b);
  const bool columns_are_told = !c.probes.structure.empty();
  for (const std::string& sentence : arrays.structure)
    if (!(columns_are_told && sentence.starts_with(kOtherColumns)) && !sentence.starts_with("the first ended as"))
      append(c.structure, {sentence});
  c.array_by_array = true;
  c.exact = arrays.exact();
  c.numbers = arrays.numbers();
  c.quantities = arrays.quantities;
}

void use_fields_and_probes(Comparison& c) {
  std::map<std::string, std::size_t> places;
  for (const ComparedBody& body : c.fields.bodies) places[body.name] = body.places;
  for (const FieldDifference& d : c.fields.fields) {
    const std::size_t numbers = places[d.body] * d.a.size();
    c.quantities.push_back({d.name(), d.relative, d.largest, d.time, numbers});
    c.numbers += numbers;
  }
  for (const ProbeDifference& d : c.probes.probes) {
    c.quantities.push_back({d.name, d.relative, d.largest, d.time, d.a.size()});
    c.numbers += d.a.size();
  }
  if (c.quantities.empty()) c.structure.emplace_back("there is no field and no probe that both have");
  std::stable_sort(c.quantities.begin(), c.quantities.end(),
                   [](const auto& p, const auto& q) { return p.relative > q.relative; });
}

void keep_only(Comparison& c, const std::vector<std::string>& only) {
  if (only.empty()) return;
  const auto means = [](const std::string& word, const std::string& name) {
    return name == word || name.ends_with(": " + word) || name.starts_with(word + "[");
  };
  for (const std::string& word : only) {
    if (std::any_of(c.quantities.begin(), c.quantities.end(), [&](const auto& q) { return means(word, q.name); }))
      continue;
    std::vector<std::string> known;
    for (const QuantityDifference& q : c.quantities) known.push_back(q.name);
    std::sort(known.begin(), known.end());
    throw InputError(fmt::format("--only {}: is no field or probe that both results have; must be of {}", word,
                                 fmt::join(known, ", ")));
  }
  std::erase_if(c.quantities, [&](const QuantityDifference& q) {
    return std::none_of(only.begin(), only.end(), [&](const std::string& word) { return means(word, q.name); });
  });
  // A probe that only one has is none of these.
  const auto others = [](const std::string& sentence) { return sentence.starts_with(kOtherColumns); };
  std::copy_if(c.structure.begin(), c.structure.end(), std::back_inserter(c.notes), others);
  std::erase_if(c.structure, others);
  c.notes.push_back(fmt::format("for the tolerance counts only: {}", fmt::join(only, ", ")));
}

InputError damaged(const fs::path& a, const fs::path& b, const Json::exception& e) {
  return InputError(fmt::format("{} or {}: summary.json is damaged: {}", a.string(), b.string(), e.what()));
}

}  // namespace

FieldComparison compare_fields(const fs::path& a, const fs::path& b, const FieldChoice& choice) try {
  const Json x = read_summary(a), y = read_summary(b);
  FieldSource source_a{SavedStates(a, x), kind_of(scene_settings(x, "A"), x), volumes_of(x)};
  FieldSource source_b{SavedStates(b, y), kind_of(scene_settings(y, "B"), y), volumes_of(y)};
  return compare_fields(source_a, source_b, choice);
} catch (const Json::exception& e) {
  throw damaged(a, b, e);
}

Comparison compare(const fs::path& a, const fs::path& b, const std::vector<std::string>& only) try {
  const Json x = read_summary(a), y = read_summary(b);
  const SceneSettings settings_a = scene_settings(x, "A"), settings_b = scene_settings(y, "B");
  const RunKind kind_a = kind_of(settings_a, x), kind_b = kind_of(settings_b, y);
  Comparison c;
  c.a = a;
  c.b = b;
  tell_ends(x, y, c);
  FieldSource source_a{SavedStates(a, x), kind_a, volumes_of(x)}, source_b{SavedStates(b, y), kind_b, volumes_of(y)};
  c.fields = compare_fields(source_a, source_b);
  c.probes = compare_probes({a, x, kind_a}, {b, y, kind_b});
  append(c.structure, c.fields.structure);
  append(c.structure, c.probes.structure);
  append(c.notes, c.fields.notes);
  append(c.notes, c.probes.notes);
  append(c.notes, settings_a.notes);
  append(c.notes, settings_b.notes);
  if (c.fields.same_meshes && c.probes.same_rows)
    use_arrays(c);
  else
    use_fields_and_probes(c);
  keep_only(c, only);
  c.energies = energy_figures(x, y);
  c.costs = cost_figures(x, y);
  if (settings_a.notes.empty() && settings_b.notes.empty()) c.settings = setting_differences(settings_a, settings_b);
  c.files = file_differences(x, y);
  c.program = program_differences(x, y);
  return c;
} catch (const Json::exception& e) {
  throw damaged(a, b, e);
}

}  // namespace fascia::app
