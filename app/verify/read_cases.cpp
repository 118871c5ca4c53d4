#include "app/list.hpp"
#include "app/reader/parse.hpp"
#include "app/reader/table_reader.hpp"
#include "app/reader/validate.hpp"
#include "app/verify/cases.hpp"
#include "core/base/errors.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// More than rounding may leave.
constexpr double kNeedsReason = 1e-6;

/// Names that were given, and where.
using Names = std::map<std::string, Place>;

void check_word(const TableReader& table, std::string_view key, const std::string& word) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
  };
  constexpr std::size_t longest = 100;
  if (word.empty() || word.size() > longest || !std::all_of(word.begin(), word.end(), allowed))
    table.error(key, fmt::format("{} must be of at most {} letters, digits and hyphens", in_quotes(word), longest));
}

std::string read_name(const TableReader& table, const std::string& what, Names& names) {
  std::string name = table.text("name").value_or("");
  if (!table.value("name")) return name;
  check_word(table, "name", name);
  const auto [other, is_new] = names.emplace(name, table.place("name"));
  if (!is_new)
    table.error("name", fmt::format("{} is the name of the {} at {}:{} too; each needs a name of its own",
                                    in_quotes(name), what, other->second.file, other->second.line));
  return name;
}

Entry read_entry(const TableReader& table) {
  const Value* at = table.value("at");
  if (!at) return {};
  if (const std::string* word = at->as_string()) {
    if (*word == "norm") return {{}, true};
    return {{static_cast<std::size_t>((*word)[0] - 'x')}, false};
  }
  Entry entry;
  const auto add = [&](const Value& index) {
    entry.indices.push_back(static_cast<std::size_t>(std::get<std::int64_t>(index.data)));
  };
  if (const Array* list = at->as_array())
    for (const Value& index : *list) add(index);
  else
    add(*at);
  return entry;
}

/// @param probes  of the scene; none where it could not be read
std::string read_probe_name(const TableReader& table, const char* key, const std::vector<std::string>* probes) {
  std::string name = table.text(key).value_or("");
  if (table.value(key) && probes && std::find(probes->begin(), probes->end(), name) == probes->end())
    table.error(key, unknown_name("probe of the scene", name, *probes));
  return name;
}

VerificationCase read_case(const TableReader& table, const std::vector<std::string>* probes, Names& names) {
  VerificationCase c;
  c.name = read_name(table, "case", names);
  c.title = table.text("title").value_or("");
  c.probe = read_probe_name(table, "probe", probes);
  c.minus = read_probe_name(table, "minus", probes);
  c.at = read_entry(table);
  c.over = table.number("over").value_or(1);
  c.value = table.number("value").value_or(0);
  c.unit = table.text("unit").value_or("");
  c.source = table.text("source").value_or("");
  c.why = table.text("why").value_or("");
  c.uncertainty = table.number("uncertainty").value_or(0);
  c.allowed.relative = table.has("allowed");
  c.allowed.error = table.number(c.allowed.relative ? "allowed" : "allowed_absolute").value_or(0);
  if (c.over == 0) table.error("over", "0 cannot divide; must be a number other than 0");
  if (table.value("source") && c.source.empty()) table.error("source", "is empty; must say where the value comes from");
  if (table.value("value") && c.value == 0 && c.allowed.relative)
    table.error("allowed", fmt::format("{} is relative to a value of 0; give allowed_absolute", c.allowed.error));
  const double allowed = c.allowed.relative ? c.allowed.error : c.allowed.error / std::abs(c.value);
  if (c.why.empty() && c.value != 0 && allowed > kNeedsReason)
    table.error("why", fmt::format("is missing; where more than {:g} is allowed it must say what limits the error",
                                   kNeedsReason));
  return c;
}

/// Tells what is wrong with a run's scene where the case file says it: a text in its own lines, a file at its key.
void tell(const SceneError& error, const TableReader& table, const VerificationRun& run) {
  const Place text = table.place("scene");
  for (const Diagnostic& d : error.diagnostics()) {
    if (d.place.file == "--set")
      table.error("set", fmt::format("{}: {}", d.place.key, d.message));
    else if (!run.text)
      table.error("file", d.text());
    else
      table.diagnostics().add({text.file, text.line + d.place.line, d.place.column, text.key + ": " + d.place.key},
                              d.message);
  }
}

/// Names of the probes of a run's scene; none where the scene is missing or wrong, which is reported.
std::optional<std::vector<std::string>> probes_of(const TableReader& table, const VerificationRun& run) {
  try {
    const Scene scene =
        run.text ? parse_scene_text(*run.text, run.scene, run.changes) : parse_scene_file(run.scene, run.changes);
    std::vector<std::string> names;
    for (const Probe& probe : scene.probes) names.push_back(probe.name);
    return names;
  } catch (const SceneError& error) {
    tell(error, table, run);
  } catch (const FileError& error) {
    table.error("file", fmt::format("{}; must be a scene, relative to this file", error.what()));
  }
  return std::nullopt;
}

VerificationRun read_run(const TableReader& table, const fs::path& file, Names& runs, Names& cases) {
  VerificationRun run;
  run.name = read_name(table, "run", runs);
  run.title = table.text("title").value_or("");
  run.topic = file.stem().string();
  if (const Value* features = table.value("features"))
    for (const Value& feature : *features->as_array()) run.features.push_back(*feature.as_string());
  for (const std::string& feature : run.features) check_word(table, "features", feature);
  run.full = table.has("level");
  run.repeated = table.boolean("repeat").value_or(false);
  run.text = table.text("scene");
  run.scene = run.text ? file : (file.parent_path() / table.text("file").value_or("")).lexically_normal();
  if (const Value* changes = table.value("set"))
    for (const Value& change : *changes->as_array()) run.changes.push_back(*change.as_string());
  const bool scene = table.value("scene") || table.value("file");
  const std::optional<std::vector<std::string>> probes = scene ? probes_of(table, run) : std::nullopt;
  for (const TableReader& c : table.tables("cases"))
    if (c.usable()) run.cases.push_back(read_case(c, probes ? &*probes : nullptr, cases));
  return run;
}

}  // namespace

Registry read_registry(const fs::path& folder) {
  std::error_code failed;
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  if (failed) throw FileError(fmt::format("{}: cannot be read: {}", folder.string(), failed.message()));
  if (files.empty()) throw FileError(fmt::format("{}: holds no case file (*.toml)", folder.string()));
  std::sort(files.begin(), files.end());
  Registry registry;
  Names runs, cases;
  std::vector<Diagnostic> wrong;
  for (const fs::path& file : files) {
    Diagnostics diagnostics(file.string());
    try {
      Value document = parse_document(io::read_file(file), diagnostics);
      validate(document, case_file_schema(), diagnostics);
      const TableReader table(&document, "", diagnostics);
      for (const TableReader& run : table.tables("runs")) {
        if (!run.usable()) continue;
        registry.push_back(read_run(run, file, runs, cases));
        registry.back().heading = table.text("title").value_or(file.stem().string());
      }
      diagnostics.throw_if_any();
    } catch (const SceneError& error) {
      wrong.insert(wrong.end(), error.diagnostics().begin(), error.diagnostics().end());
    } catch (const InputError& error) {
      wrong.push_back({{file.string(), 1, 1, ""}, error.what()});
    }
  }
  if (!wrong.empty()) throw SceneError(std::move(wrong));
  return registry;
}

fs::path cases_folder() { return scenes_folder() / "cases"; }

}  // namespace fascia::app
