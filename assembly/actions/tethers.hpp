#pragma once

#include "assembly/actions/directions.hpp"
#include "assembly/simulation/simulation.hpp"

#include <functional>
#include <optional>

/// Springs that hold material in its place, or in that of another body, where weights do not interpolate.
namespace fascia {

/// Ties the positions of a region's material, for bodies whose weights do not interpolate, and of thin ones the
/// rotations.
/// @returns how many places it ties
/// @throws SceneError  a place that an earlier constraint takes elsewhere
int add_tethers(Simulation& simulation, PointSetBuilder& points, int body, const Constraint& constraint, int motion,
                TiedPlaces& tied);

/// How the other body of a coupling moves a place; none where it is not there.
using HostOf = std::function<std::optional<Attachment>(const Vec3d&)>;

/// Ties the material of a coupling's region to that of the other body, and of a thin body that is welded the rotations.
void tie_material(Simulation& simulation, PointSetBuilder& points, const Coupling& coupling, BuiltCoupling& built,
                  const HostOf& host_of);

}  // namespace fascia
