#pragma once

#include "core/math/vec3.hpp"

#include <vector>

namespace fascia {

/// For each point the lowest index of a point within `tolerance` [m] of it (itself where there is none).
/// The tolerance must be above zero and above 1e-15 of the points' extent. A representative stands for itself, so
/// result[result[i]] == result[i].
std::vector<int> weld_points(const std::vector<Vec3d>& points, double tolerance);

}  // namespace fascia
