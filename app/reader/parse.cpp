#include "app/reader/parse.hpp"

#include "app/reader/overrides.hpp"
#include "app/reader/readers.hpp"
#include "app/reader/text_checks.hpp"
#include "app/reader/validate.hpp"
#include "assembly/specification/check.hpp"
#include "core/base/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace fascia::app {
namespace {

constexpr std::size_t max_file_size = std::size_t{16} << 20;

/// At most a little more than the largest size of a scene.
std::string read_file(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw FileError(fmt::format("{}: is a directory; must be a scene file", path.string()));
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FileError(fmt::format("{}: cannot be opened: {}", path.string(), std::strerror(errno)));
  std::string text;
  std::array<char, 65536> part;
  while (text.size() <= max_file_size && (file.read(part.data(), part.size()), file.gcount() > 0))
    text.append(part.data(), static_cast<std::size_t>(file.gcount()));
  if (file.bad()) throw FileError(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(errno)));
  return text;
}

/// Every key of every table, by its full path.
void collect_places(const Value& value, const std::string& path, const Diagnostics& diagnostics,
                    std::map<std::string, Place>& places) {
  if (const Table* members = value.as_table())
    for (const Member& member : *members) {
      const std::string key = join(path, member.key);
      places.emplace(key, diagnostics.place(member.position, key));
      collect_places(member.value, key, diagnostics, places);
    }
  const Array* items = value.as_array();
  if (items == nullptr || items->empty() || items->front().as_table() == nullptr) return;
  for (std::size_t i = 0; i < items->size(); ++i) {
    const std::string key = join(path, i);
    places.emplace(key, diagnostics.place((*items)[i].position, key));
    collect_places((*items)[i], key, diagnostics, places);
  }
}

/// The scene's file gives its name to files of the result, and to a place in summary.json.
void check_name(const std::filesystem::path& path, Diagnostics& diagnostics) {
  constexpr std::size_t longest = 255 - std::string_view(".pvd").size();
  const std::string stem = path.stem().string();
  if (stem.size() > longest)
    diagnostics.add(Position{}, "",
                    fmt::format("the file's name has {} bytes, so that SCENE.pvd of its results would have more than "
                                "a file system takes; use at most {} before .toml",
                                stem.size(), longest));
  try {
    check_encoding(stem);
  } catch (const SyntaxError&) {
    diagnostics.add(Position{}, "", "the file's name is no UTF-8, as summary.json must be; rename the file");
  }
}

Scene read_scene(const TableReader& table, const std::filesystem::path& path) {
  Scene scene;
  scene.path = path;
  scene.title = table.text("title").value_or("");
  if (const Value* silenced = table.value("silence"))
    for (const Value& name : *silenced->as_array())
      if (const std::string* text = name.as_string()) scene.silenced.push_back(*text);
  scene.world = read_world(table);
  const Materials materials = read_materials(table);
  std::vector<std::string> bodies;
  for (const TableReader& body : table.tables("bodies")) bodies.push_back(body.name());
  for (const TableReader& body : table.tables("bodies"))
    if (body.usable())
      scene.bodies.push_back(read_body(body, materials, bodies, path.parent_path(), states_need(table)));
  for (const TableReader& constraint : table.tables("constraints")) {
    scene.constraints.push_back(read_constraint(constraint, bodies));
    check_model(constraint, scene.constraints.back(), scene.bodies);
  }
  for (const TableReader& load : table.tables("loads")) scene.loads.push_back(read_load(load, bodies));
  for (const TableReader& coupling : table.tables("couplings"))
    scene.couplings.push_back(read_coupling(coupling, bodies));
  for (const Diagnostic& circle : circles_of(scene.bodies)) table.diagnostics().add(circle.place, circle.message);
  check_surfaces(scene, bodies, table.diagnostics());
  scene.solver = read_solver(table, bodies);
  const std::optional<SolverKind> kind = read_solver_kind(table);
  for (const TableReader& probe : table.tables("probes")) {
    scene.probes.push_back(read_probe(probe, bodies, kind));
    check_model(probe, scene.probes.back(), scene.bodies);
  }
  const bool shells =
      scene.bodies.size() < bodies.size() || std::any_of(scene.bodies.begin(), scene.bodies.end(), is_shell);
  scene.output = read_output(table, path.stem().string(), kind, shells);
  read_need(table, scene);
  return scene;
}

}  // namespace

Value parse_document(std::string_view text, Diagnostics& diagnostics) {
  if (text.size() > max_file_size) {
    diagnostics.add(Position{}, "toml", "the file is larger than 16 MiB; must be a scene, which is small");
    diagnostics.throw_if_any();
  }
  try {
    return parse_toml(text);
  } catch (const SyntaxError& error) {
    const std::string remedy = error.remedy.empty() ? "" : "; " + error.remedy;
    diagnostics.add(error.position, "toml", one_line(error.message) + remedy);
    diagnostics.throw_if_any();
    throw;
  }
}

Scene parse_scene_text(std::string_view text, const std::filesystem::path& path,
                       const std::vector<std::string>& overrides) {
  Diagnostics diagnostics(path.string());
  check_name(path, diagnostics);
  Value document = parse_document(text, diagnostics);
  for (const std::string& change : overrides) apply_override(document, change, diagnostics);
  validate(document, scene_schema(), diagnostics);
  Scene scene = read_scene(TableReader(&document, "", diagnostics), path);
  diagnostics.throw_if_any();
  scene.text = text;
  collect_places(document, "", diagnostics, scene.places);
  scene.overrides = overrides;
  return scene;
}

Scene parse_scene_file(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  return parse_scene_text(read_file(path), path, overrides);
}

}  // namespace fascia::app
