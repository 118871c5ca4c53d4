#pragma once

#include "app/simulation.hpp"

namespace fascia::app {

/// The places of a body's matter: its integration points, and the nodes of its mesh or, of a meshless or rigid body,
/// the points of its surface. Frames of a grid that lie outside are none.
std::vector<MatterPoint> matter_of(const SimulatedBody& body);

/// A node by itself.
MatterPoint matter_at(int node);

/// The largest displacement of matter [m].
double largest_displacement(const std::vector<MatterPoint>& matter, const State& state);

/// The mean displacement of matter [m], weighted with volume at rest; of what has none the mean of its places.
Vec3d mean_displacement(const std::vector<MatterPoint>& matter, const State& state);

}  // namespace fascia::app
