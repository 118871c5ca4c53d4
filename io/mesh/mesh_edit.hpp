#pragma once

#include "core/geometry/mesh.hpp"

namespace fascia::io {

/// Removes points that no cell uses and numbers the others anew, in their order.
/// @param keep  one for each point; every point that a cell uses must be kept
void keep_points(Mesh& mesh, const std::vector<bool>& keep);

}  // namespace fascia::io
