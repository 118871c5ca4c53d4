#pragma once

#include "app/assembly/simulation.hpp"
#include "app/run/backend.hpp"
#include "app/run/run_scene.hpp"

namespace fascia::app {

/// The scene of a command with its overrides.
Scene read_scene(const RunOptions& options);

/// Builds what is simulated; prints the warnings. @param scene  states no need
Simulation load_scene(Scene scene);

/// Reads the scene of a command with its overrides, and builds what is simulated; prints the warnings.
Simulation load_scene(const RunOptions& options);

/// Prints, and keeps, a warning where the backend does not do what the scene asks for.
void warn_of_backend(Simulation& s, Backend backend);

}  // namespace fascia::app
