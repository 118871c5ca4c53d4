#pragma once

#include "assembly/simulation/simulation.hpp"
#include "meshless/sample_store.hpp"

namespace fascia {

/// Turns a scene into a model.
/// @throws SceneError  what only the geometry shows: a region that selects nothing, contradicting constraints, a static
///                     problem that nothing holds, more memory than there is
/// @throws FileError, InputError  meshes
/// @param store  of samples of matter that were made before; null: none
Simulation build_simulation(Scene scene, const SampleStore* store = nullptr);

/// Looks at everything that the description of a scene shows, for no reader has, and turns it into a model.
/// @throws SceneError  all that is wrong there, by key; and as build_simulation()
Simulation build_checked(Scene scene);

}  // namespace fascia
