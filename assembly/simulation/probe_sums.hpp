#pragma once

#include "assembly/simulation/probe_values.hpp"
#include "core/structure/inertia.hpp"

/// Sums that probes show: of a body or of all, or of what the nodes of a region move.
namespace fascia {

/// Deformed volume: Σ v det F over integration points, and what surfaces of rigid bodies enclose [m³].
double deformed_volume(const Simulation& simulation, const ResolvedProbe& probe, const State& state);

struct Energies {
  double elastic = 0, stabilization = 0, potential = 0;  ///< [J]
};
Energies energies(const Simulation& simulation, const ResolvedProbe& probe, const ProbedState& snap);

double kinetic_energy(const Simulation& simulation, const ResolvedProbe& probe, const State& state);
/// About the probe's point.
Momentum momentum(const Simulation& simulation, const ResolvedProbe& probe, const State& state);

}  // namespace fascia
