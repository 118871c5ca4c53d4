#pragma once

#include "fascia/run/run_listener.hpp"

namespace fascia {

/// Finds the natural modes that a scene asks for, and shows each: the shape, scaled so that its largest displacement is
/// a tenth of the largest body, and its frequency. Warns of modes that frames have and matter hardly feels, and of what
/// rounding leaves open.
RunEnd run_modes(const Simulation& simulation, ThreadPool& pool, RunListener& listener);

}  // namespace fascia
