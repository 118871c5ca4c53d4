#pragma once

#include "assembly/simulation/simulation.hpp"

namespace fascia {

/// Warns of edges of a shell that nothing holds and that bulge at a state because of their triangles: couples of a
/// tension along a curved edge do not cancel there (docs/manual/shells.md, "Thin shells that are pulled").
void warn_of_edge_bulges(const Simulation& simulation, const SimulatedBody& shell, const State& end,
                         Warnings& warnings);

}  // namespace fascia
