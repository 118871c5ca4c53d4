#pragma once

#include "fascia/run/run_listener.hpp"

namespace fascia {

/// Adds what a built scene lacks before its run: its imperfection, and of central differences the time step.
/// @throws SceneError  an imperfection that nothing can give; a time step above the stable one
void make_ready(Simulation& simulation);

/// Takes all steps of a simulation, of whatever kind its solver is, on a backend that computes it.
/// @throws BackendError  a GPU that fails before a step was taken, where the scene asks for it
/// @throws InputError    a node without inertia in dynamics, more than a GPU can number
/// @throws StateError    a mode with a value that is not finite
RunEnd run_simulation(const Simulation& simulation, Backend backend, ThreadPool& pool, RunListener& listener);

}  // namespace fascia
