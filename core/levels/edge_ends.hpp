#pragma once

#include "core/structure/model.hpp"

#include <array>
#include <vector>

namespace fascia {

/// The ends of the edge that a vertex of quadratic elements lies in the middle of, by node; −1 of all others.
using EdgeEnds = std::vector<std::array<int, 2>>;

/// Finds them by where the nodes of an element lie at rest: a vertex is in the middle where it is nearer to it than a
/// twentieth of the edge's length. Nodes of edges that are more curved have none, since the mean of the ends' motions
/// would not be theirs; nor have those whose ends depend on other nodes or lie in the middle of edges themselves.
EdgeEnds find_edge_ends(const Model& model);

}  // namespace fascia
