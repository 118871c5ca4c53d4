#include "app/need/chosen.hpp"

#include "app/reader/scene_tree.hpp"
#include "app/scene/diagnostics.hpp"
#include "app/scene/toml_text.hpp"
#include "io/files.hpp"
#include "io/result_directory.hpp"

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

}  // namespace

std::string chosen_scene(const Scene& scene, const std::vector<std::string>& overrides,
                         const std::vector<std::string>& comments, const fs::path& folder) {
  Value document = scene_tree(scene, overrides);
  move_files(document, scene.path.parent_path(), folder);
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

void write_chosen_scene(const Scene& scene, const std::vector<std::string>& overrides,
                        const std::vector<std::string>& comments) {
  const fs::path directory = scene.output.directory;
  io::replace_file(directory / io::kChosenScene, chosen_scene(scene, overrides, comments, directory));
}

RunOptions options_of_choice(const RunOptions& options, const Scene& scene, const std::vector<std::string>& overrides) {
  RunOptions run = options;
  run.overrides = scene.overrides;
  run.overrides.insert(run.overrides.end(), overrides.begin(), overrides.end());
  run.text = scene.text;
  run.backend.reset(), run.threads.reset(), run.gpus.reset();  // they are among the scene's overrides
  run.estimate = false, run.no_estimate = true;
  run.new_trials = false;
  return run;
}

}  // namespace fascia::app
