#pragma once

#include "assembly/simulation/simulation.hpp"

namespace fascia {

/// Turns a scene into a model.
/// @throws SceneError  what only the geometry shows: a region that selects nothing, contradicting constraints, a static
///                     problem that nothing holds, more memory than there is
/// @throws FileError, InputError  meshes
Simulation build_simulation(Scene scene);

}  // namespace fascia
