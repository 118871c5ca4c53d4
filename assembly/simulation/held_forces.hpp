#pragma once

#include "assembly/simulation/simulation.hpp"
#include "core/math/wrench.hpp"
#include "core/solver/reached.hpp"

#include <vector>

/// The forces of constraints at a state, with weight and inertia of what they hold.
namespace fascia {

/// Forces by degrees of freedom that hold the constrained ones, in the axes of the world; those of free ones are zero.
std::vector<double> held_forces(const Simulation& s, const ReachedForces& acting);

/// A force of a constraint on its node, and the torque there. @param held  of held_forces()
Wrench held_at(const Simulation& s, const State& state, const std::vector<double>& held, const FrameConstraint& c);

/// A force on material that a constraint ties to its place, and its moment about a point.
Wrench held_material(const Simulation& s, const State& state, const ReachedForces& acting, const TetheredMaterial& m,
                     const Vec3d& about);

/// Force and moment about a point that a motion of the model exerts on the nodes and the material that follow it, along
/// the axes in which they do.
Wrench force_of_motion(const Simulation& s, const State& state, const ReachedForces& acting, int motion,
                       const Vec3d& about);

}  // namespace fascia
