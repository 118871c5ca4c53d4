#pragma once

#include "assembly/simulation/simulation.hpp"

#include <string>

namespace fascia::app {

/// One line on the tangent that the first solve of a run meets at rest, with the inertia of a time step: its condition,
/// and what follows from it for conjugate gradients and for a direct solve. Empty where the run solves no tangent.
/// Where a factor would take more than about a second the line says that it was left out.
std::string condition_line(const Simulation& simulation);

}  // namespace fascia::app
