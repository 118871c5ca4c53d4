#pragma once

#include "assembly/simulation/simulation.hpp"

#include <string>

namespace fascia::app {

/// Tells of a slender or flat body of elements of order 1 that has no node inside: one element through its thickness,
/// which hardly bends. Empty otherwise.
std::string thickness_line(const Simulation& simulation, std::size_t body);

}  // namespace fascia::app
