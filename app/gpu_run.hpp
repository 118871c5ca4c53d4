#pragma once

#include "app/simulation.hpp"
#include "gpu/run.hpp"

#include <functional>
#include <optional>

namespace fascia::app {

/// Statics or dynamics on the GPU. A device that is lost, or has no memory left after a step, ends the run with what
/// was seen last. None where it has too little memory from the start and the scene leaves the choice: a warning says
/// so.
/// @param observed  of explicit dynamics, as in ExplicitSettings
/// @throws BackendError  too little memory, where the GPU was asked for
std::optional<RunReport> run_on_gpu(const Simulation& simulation, State& state, const FactorFunction& factors,
                                    const SolverSettings& settings, const gpu::DeviceObserver& observe,
                                    const std::function<bool(const StepInfo&)>& observed = {});

}  // namespace fascia::app
