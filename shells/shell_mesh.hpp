#pragma once

#include "core/model/model_body.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace fascia {

/// A triangulated mid-surface as shells use it: each connected part consistently oriented, outward where it is closed.
struct ShellMesh {
  std::vector<Vec3d> nodes;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::int64_t> file_number;  ///< of the triangles, for messages; empty where generated
  std::vector<BodyGroup> groups;          ///< nodes and triangles of each named group
  std::vector<std::string> messages;      ///< what was repaired or looks bad
  std::string file;
};

}  // namespace fascia
