#pragma once

#include "app/assembly/simulation.hpp"
#include "app/results/warnings.hpp"
#include "core/run/modes.hpp"

namespace fascia::app {

/// What is to be said of natural modes: those that frames have and matter hardly feels, and what rounding leaves open.
void warn_of_modes(const Modes& modes, const Simulation& simulation, Warnings& warnings);

}  // namespace fascia::app
