#pragma once

#include "app/run/run_scene.hpp"
#include "assembly/simulation/simulation.hpp"
#include "fascia/choose_backend.hpp"

namespace fascia::app {

/// The scene of a command with its overrides.
Scene read_scene(const RunOptions& options);

/// Builds what is simulated; prints the warnings. @param scene  states no need
Simulation load_scene(Scene scene);

/// Reads the scene of a command with its overrides, and builds what is simulated; prints the warnings.
Simulation load_scene(const RunOptions& options);

/// Prints, and keeps, a warning where the backend does not do what the scene asks for.
void warn_of_backend(Simulation& s, Backend backend);

/// build_simulation(), where the memory of the machine seems to suffice.
/// @throws SceneError  it does not; and as build_simulation()
Simulation build_within_memory(Scene scene);

}  // namespace fascia::app
