#pragma once

#include "app/reader/parse.hpp"
#include "assembly/specification/errors.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace fascia::app::test {

/// The start of a scene that is right; what a test adds follows.
inline constexpr std::string_view beam = R"([materials.soft]
young = "40 kPa"
poisson = 0.3
[bodies.beam]
model = "meshless"
domain = { box = { min = [0, 0, 0], max = [4, 1, 1] } }
mass = "5 kg"
material = "soft"
frames = { grid = [5, 2, 2] }
)";
inline constexpr int beam_lines = 9;

inline Scene parse(std::string_view text, const std::vector<std::string>& overrides = {}) {
  return parse_scene_text(text, "a.toml", overrides);
}

/// The beam and more.
inline Scene parse_beam(std::string_view more, const std::vector<std::string>& overrides = {}) {
  return parse(std::string(beam) + std::string(more), overrides);
}

/// All messages of a scene that is wrong; empty for one that is right.
inline std::string errors_of(std::string_view text, const std::vector<std::string>& overrides = {}) {
  try {
    parse(text, overrides);
    return "";
  } catch (const SceneError& error) {
    return error.what();
  }
}

/// The messages of the beam and more, which starts at line 10.
inline std::string errors_of_beam(std::string_view more, const std::vector<std::string>& overrides = {}) {
  return errors_of(std::string(beam) + std::string(more), overrides);
}

/// The beam with one line replaced.
inline std::string beam_with(std::string_view line, std::string_view by) {
  std::string text(beam);
  text.replace(text.find(line), line.size(), by);
  return text;
}

/// A body "block" of finite elements: `more` from line 9 on.
/// @param domain  the keys inside of domain = { }, at column 12 of line 6
inline std::string mesh_body(std::string_view model, std::string_view domain, std::string_view more = "") {
  return "[materials.soft]\nyoung = 1\npoisson = 0.3\n[bodies.block]\nmodel = \"" + std::string(model) +
         "\"\ndomain = { " + std::string(domain) + " }\nmass = 1\nmaterial = \"soft\"\n" + std::string(more);
}
inline constexpr std::string_view meshed_box = "box = { min = [0, 0, 0], max = [4, 1, 1], cells = [8, 2, 2] }";

/// A shell "skin": keys from line 7 on.
inline std::string shell_body(std::string_view domain, std::string_view more) {
  return "[materials.soft]\nyoung = 1\npoisson = 0.3\n[bodies.skin]\nmodel = \"shell\"\ndomain = { " +
         std::string(domain) + " }\n" + std::string(more) + "mass = 1\nmaterial = \"soft\"\n";
}

/// A body "skin" on another domain: keys from line 7 on.
inline std::string thin_body(std::string_view domain, std::string_view more) {
  return "[materials.soft]\nyoung = 1\npoisson = 0.3\n[bodies.skin]\nmodel = \"meshless\"\ndomain = { " +
         std::string(domain) + " }\n" + std::string(more) + "mass = 1\nmaterial = \"soft\"\n";
}
inline constexpr std::string_view rectangle =
    "rectangle = { origin = [0, 0, 0], edge_u = [2, 0, 0], edge_v = [0, 1, 0] }";
inline constexpr std::string_view line = "line = { from = [0, 0, 0], to = [0, 0, 3] }";
inline constexpr std::string_view mesh = "file = \"skin.msh\"";

}  // namespace fascia::app::test
