#include "app/reader/scene_tree.hpp"

#include "app/reader/overrides.hpp"
#include "app/scene/diagnostics.hpp"
#include "app/scene/toml_text.hpp"

#include <algorithm>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

void remove_keys(Value& table, const std::vector<std::string>& keys) {
  if (Table* members = table.as_table())
    std::erase_if(*members, [&](const Member& m) { return std::find(keys.begin(), keys.end(), m.key) != keys.end(); });
}

/// Keys in their order, and whole numbers as others are.
void make_plain(Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value.data)) value.data = static_cast<double>(*whole);
  if (Table* members = value.as_table()) {
    std::sort(members->begin(), members->end(), [](const Member& a, const Member& b) { return a.key < b.key; });
    for (Member& m : *members) make_plain(m.value);
  } else if (Array* items = value.as_array()) {
    for (Value& item : *items) make_plain(item);
  }
}

void move_file(Value& table, const fs::path& from, const fs::path& to) {
  Value* file = table.find("file");
  if (!file || !file->as_string()) return;
  std::error_code none;
  const fs::path path = fs::weakly_canonical(from / *file->as_string(), none);
  const fs::path moved = fs::relative(path, fs::weakly_canonical(to, none), none);
  file->data = (moved.empty() ? path : moved).string();
}

std::optional<TreeDifference> difference(const Value& first, const Value& second, bool additions,
                                         const std::string& path) {
  const Table *a = first.as_table(), *b = second.as_table();
  if (!a || !b) {
    if (toml_text(first) == toml_text(second)) return std::nullopt;
    return TreeDifference{path, toml_text(first), toml_text(second)};
  }
  const auto below = [&](const Member& m) { return path.empty() ? toml_key(m.key) : path + "." + toml_key(m.key); };
  for (const Member& m : *a) {
    const Value* other = second.find(m.key);
    if (!other) return TreeDifference{below(m), toml_text(m.value), ""};
    if (auto found = difference(m.value, *other, additions, below(m))) return found;
  }
  for (const Member& m : *b)
    if (additions && !first.find(m.key)) return TreeDifference{below(m), "", toml_text(m.value)};
  return std::nullopt;
}

}  // namespace

Value scene_tree(const Scene& scene, const std::vector<std::string>& changes) {
  Diagnostics diagnostics(scene.path.string());
  Value tree = parse_toml(scene.text);
  for (const std::string& change : scene.overrides) apply_override(tree, change, diagnostics);
  for (const std::string& change : changes) apply_override(tree, change, diagnostics);
  diagnostics.throw_if_any();
  return tree;
}

const Value* value_at(const Value& tree, std::string_view path) {
  const Value* value = &tree;
  while (value && !path.empty()) {
    const std::size_t dot = path.find('.');
    value = value->find(path.substr(0, dot));
    path = dot == std::string_view::npos ? "" : path.substr(dot + 1);
  }
  return value;
}

std::vector<std::string> possible_changes(const Scene& scene, const std::vector<std::string>& changes) {
  Value tree = scene_tree(scene, {});
  std::vector<std::string> possible;
  for (const std::string& change : changes) {
    Diagnostics trouble(scene.path.string());
    apply_override(tree, change, trouble);
    if (trouble.empty() || !change.ends_with('=')) possible.push_back(change);
  }
  return possible;
}

void move_files(Value& tree, const fs::path& from, const fs::path& to) {
  Value* bodies = tree.find("bodies");
  if (!bodies || !bodies->as_table()) return;
  for (Member& body : *bodies->as_table())
    for (const char* part : {"domain", "frames", "points"})
      if (Value* table = body.value.find(part); table && table->as_table()) move_file(*table, from, to);
}

Value plain_tree(const Scene& scene, const std::vector<std::string>& changes, const std::vector<std::string>& without) {
  Value tree = scene_tree(scene, changes);
  move_files(tree, scene.path.parent_path(), "/");
  remove_keys(tree, {"title", "need"});
  remove_keys(tree, without);
  if (Value* output = tree.find("output")) remove_keys(*output, {"directory"});
  if (Value* bodies = tree.find("bodies"); bodies && bodies->as_table())
    for (Member& body : *bodies->as_table()) remove_keys(body.value, {"need"});
  make_plain(tree);
  return tree;
}

std::optional<TreeDifference> tree_difference(const Value& first, const Value& second, bool additions) {
  return difference(first, second, additions, "");
}

}  // namespace fascia::app
