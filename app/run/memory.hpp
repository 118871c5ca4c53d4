#pragma once

#include "assembly/simulation/simulation.hpp"

namespace fascia::app {

/// Rough memory of a scene [bytes], known before anything is allocated.
double estimated_memory(const Scene& scene);

/// Refuses a scene before anything is allocated for it.
/// @throws SceneError  the rough memory is more than there is, with the place of the largest body
void check_memory(const Scene& scene);

/// The peak of a run [bytes], as summary.json will report it. All that a run holds while it solves is set up for this
/// beside the model, up to the analysis of the factor, and measured; what the factor, the solver's vectors and the
/// results add is computed.
/// @param on_gpu  the GPU solves, in memory of its own
/// @throws SceneError  as check_run_memory(), where not even that fits
double run_memory(const Simulation& simulation, bool on_gpu);

/// Refuses a run that cannot fit, before it starts: where it may come near what is free, the closer figure decides.
/// @throws SceneError  with the place of the largest body
void check_run_memory(const Simulation& simulation, bool on_gpu);

}  // namespace fascia::app
