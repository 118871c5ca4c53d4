#include "app/need/chosen.hpp"

#include "app/reader/overrides.hpp"
#include "app/scene/diagnostics.hpp"
#include "app/scene/document.hpp"
#include "app/scene/toml_text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

bool is_list_of_tables(const Value& value) {
  const Array* items = value.as_array();
  return items && !items->empty() && items->front().as_table();
}

/// Headings for tables down to [bodies.NAME]; what is deeper stands inline.
void write(const Table& members, const std::string& path, int depth, std::string& text) {
  const auto has_heading = [&](const Member& m) {
    return (depth < 2 && m.value.as_table()) || (depth == 0 && is_list_of_tables(m.value));
  };
  for (const Member& m : members)
    if (!has_heading(m)) text += fmt::format("{} = {}\n", toml_key(m.key), toml_text(m.value));
  for (const Member& m : members) {
    if (!has_heading(m)) continue;
    const std::string whole = path.empty() ? toml_key(m.key) : path + "." + toml_key(m.key);
    if (const Array* items = m.value.as_array()) {
      for (const Value& item : *items) {
        text += fmt::format("\n[[{}]]\n", whole);
        write(*item.as_table(), whole, 2, text);
      }
      continue;
    }
    const Table& table = *m.value.as_table();
    const bool only_tables =
        !table.empty() && depth == 0 &&
        std::all_of(table.begin(), table.end(), [](const Member& t) { return t.value.as_table(); });
    if (!only_tables) text += fmt::format("\n[{}]\n", whole);
    write(table, whole, depth + 1, text);
  }
}

/// Paths of files, relative to another folder than the scene's.
void move_files(Value& table, const fs::path& from, const fs::path& to) {
  Value* file = table.find("file");
  if (!file || !file->as_string()) return;
  std::error_code none;
  const fs::path path = fs::weakly_canonical(from / *file->as_string(), none);
  const fs::path moved = fs::relative(path, fs::weakly_canonical(to, none), none);
  file->data = (moved.empty() ? path : moved).string();
}

}  // namespace

std::string chosen_scene(const Scene& scene, const std::vector<std::string>& overrides,
                         const std::vector<std::string>& comments, const fs::path& folder) {
  Value document = parse_toml(scene.text);
  Diagnostics diagnostics(scene.path.string());
  for (const std::string& change : scene.overrides) apply_override(document, change, diagnostics);
  for (const std::string& change : overrides) apply_override(document, change, diagnostics);
  diagnostics.throw_if_any();
  if (Value* bodies = document.find("bodies"))
    for (Member& body : *bodies->as_table())
      for (const char* part : {"domain", "frames", "points"})
        if (Value* table = body.value.find(part); table && table->as_table())
          move_files(*table, scene.path.parent_path(), folder);
  if (Value* output = document.find("output")) {
    std::erase_if(*output->as_table(), [](const Member& m) { return m.key == "directory"; });
    if (output->as_table()->empty())
      std::erase_if(*document.as_table(), [](const Member& m) { return m.key == "output"; });
  }
  std::string text;
  for (const std::string& line : comments) text += "# " + one_line(line) + "\n";
  write(*document.as_table(), "", 0, text);
  return text;
}

}  // namespace fascia::app
