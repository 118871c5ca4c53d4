#pragma once

#include "assembly/simulation/simulation.hpp"

#include <string>
#include <vector>

/// Places of a model in the words of a scene.
namespace fascia {

/// "element 12 at (0.1, 0, 0.05)", "triangle 3 at ..", "the integration point at ..": the cell of an integration point,
/// with its centre, or the point itself where there are no cells.
std::string point_name(const SimulatedBody& body, std::size_t point);

/// At rest: the mean of the corners of its cell, or the point itself [m].
Vec3d point_place(const SimulatedBody& body, std::size_t point);

/// The body that a node of the model belongs to; of those that share it the one that brought it.
int body_of_node(const Simulation& simulation, int node);

/// The length over which the fastest weight of an attachment falls [m]: the shortest height of a linear tetrahedron.
double weight_length(const Attachment& attachment);

/// The material of an integration point: of the body's, the one whose constants it has.
const Material* material_of(const Body& body, const BodyPoint& point);

}  // namespace fascia
