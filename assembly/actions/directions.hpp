#pragma once

#include "assembly/simulation/simulation.hpp"

#include <array>
#include <map>
#include <utility>
#include <vector>

namespace fascia {

/// Prescribed directions of a frame's translation or rotation, orthonormal.
struct Directions {
  std::vector<Vec3d> axis;
  std::vector<int> motion;  ///< −1: held
};

/// Prescribed directions of a frame or of a place in the matter.
struct HeldDirections {
  Directions translation, rotation;
};

/// What is tied of a body's matter already: by body and rest position.
using TiedPlaces = std::map<std::pair<int, std::array<double, 3>>, HeldDirections>;

/// Ties the positions of a region's material, for bodies whose weights do not interpolate, and of thin ones the
/// rotations (tethers.cpp).
/// @returns how many places it ties
/// @throws SceneError  a place that an earlier constraint takes elsewhere
int add_tethers(Simulation& simulation, PointSetBuilder& points, int body, const Constraint& constraint, int motion,
                TiedPlaces& tied);

/// Adds a direction; one that is already there must ask for the same.
/// @param motion    index into Model::motions, −1: held
/// @param rotation  the directions are axes of rotation
/// @throws SceneError  another value on the same axis, or an axis that is oblique to one that moves
void add_direction(const Simulation& s, Directions& d, const Vec3d& direction, int motion, bool rotation,
                   const Vec3d& X, const Constraint& constraint);

}  // namespace fascia
