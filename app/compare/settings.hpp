#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace fascia::app {

/// A setting, or a fact about a run, in two results.
struct Difference {
  std::string name;
  std::string a, b;  ///< as they were written; empty: that result does not have it
};

/// Keys of a result's scene after its overrides: "bodies.beam.frames.grid" → "[3, 2, 2]", in the order of the text.
/// Lists of tables count from zero: "constraints[0].body".
struct SceneSettings {
  struct Entry {
    std::string key, text;
    std::string value;  ///< the same for values that mean the same: quantities in SI
  };
  std::vector<Entry> entries;
  std::vector<std::string> notes;

  /// The text of a value without quotes; empty where the scene does not have the key.
  std::string value_of(const std::string& key) const;
};

/// @param name  "A", for notes
SceneSettings scene_settings(const nlohmann::ordered_json& summary, const std::string& name);

/// Keys whose values differ, in the order of A, then of B. "40 kPa" and 40000 are the same.
std::vector<Difference> setting_differences(const SceneSettings& a, const SceneSettings& b);

/// Files that both scenes read under one name with other content.
std::vector<Difference> file_differences(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

}  // namespace fascia::app
