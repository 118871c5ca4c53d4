#pragma once

#include "assembly/simulation/simulation.hpp"
#include "assembly/specification/warnings.hpp"
#include "core/run/modes.hpp"

namespace fascia::app {

/// Warns of natural modes that frames have and matter hardly feels, and of what rounding leaves open.
void warn_of_modes(const Modes& modes, const Simulation& simulation, Warnings& warnings);

}  // namespace fascia::app
