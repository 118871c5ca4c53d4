#pragma once

#include "assembly/simulation/simulation.hpp"
#include "gpu/run/run.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fascia {

/// Takes a sentence on what is not computed where, or with what precision, the scene asks for.
using BackendWarning = std::function<void(const std::string&)>;

struct GpuRun {
  RunReport report;
  int gpus = 1;  ///< that computed it
};

/// Statics or dynamics on the GPU, or on several that share it. A device that is lost, or has no memory left after a
/// step, ends the run with what was seen last. None where it has too little memory from the start and the scene leaves
/// the choice, as it does where there are fewer GPUs than it asks for or they cannot share it: `warn` is told so.
/// @param observed  of explicit dynamics, as in ExplicitSettings
/// @throws BackendError  what is missing, where the GPU was asked for
std::optional<GpuRun> run_on_gpu(const Simulation& simulation, State& state, const FactorFunction& factors,
                                 const SolverSettings& settings, const BackendWarning& warn,
                                 const gpu::DeviceObserver& observe,
                                 const std::function<bool(const StepInfo&)>& observed = {});

}  // namespace fascia
