#pragma once

#include "app/scene/document.hpp"
#include "assembly/specification/scene.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Scenes as trees of their keys, to be written, kept and compared.
namespace fascia::app {

/// The tree of a scene's file with the scene's own changes ("key.path=value") and more behind them.
/// @throws SceneError  a change that cannot be made
Value scene_tree(const Scene& scene, const std::vector<std::string>& changes);

/// The value of a path of bare keys, "bodies.beam.order"; null where there is none.
const Value* value_at(const Value& tree, std::string_view path);

/// Those changes of a scene that can be made one behind the other: removals of keys that are not there are left out.
std::vector<std::string> possible_changes(const Scene& scene, const std::vector<std::string>& changes);

/// Paths of files that bodies name begin in another folder.
void move_files(Value& tree, const std::filesystem::path& from, const std::filesystem::path& to);

/// Makes one tree of all texts that make the same simulation: keys are sorted, numbers are alike whether they have a
/// point or not, paths of files are whole, and what changes no result is missing (title, needs, where the output goes).
/// @param without  keys of the scene that are left out too
Value plain_tree(const Scene& scene, const std::vector<std::string>& changes,
                 const std::vector<std::string>& without = {});

/// A key that two trees differ in; a value that is missing is empty.
struct TreeDifference {
  std::string key, first, second;
};

/// The first one, of plain trees. @param additions  whether what the second alone has counts
std::optional<TreeDifference> tree_difference(const Value& first, const Value& second, bool additions);

}  // namespace fascia::app
