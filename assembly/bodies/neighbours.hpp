#pragma once

#include "assembly/bodies/bodies.hpp"
#include "assembly/simulation/simulation.hpp"

#include <vector>

/// What a body takes from others: shared frames, and the space between two of them.
namespace fascia {

/// Indices of the bodies, each behind those that it takes from; otherwise in the order of the scene.
std::vector<std::size_t> build_order(const Scene& scene);

/// Fills the shared frames and the domain between bodies. Those bodies are built.
/// @throws SceneError  a region that selects nothing; InputError  bodies that do not face each other
void gather_neighbours(Simulation& simulation, const Body& body, BodyBuild& build);

/// Vertices that a body shares and that turn for it get a rotation.
void give_rotations(Model& model, const std::vector<SharedFrame>& shared, const ModelBody& body);

}  // namespace fascia
