#pragma once

#include "fem/element_mesh.hpp"

namespace fascia {

/// The volume cells of a file as elements, with the file's groups.
///
/// A cell that the file repeats for several groups becomes one element of all of them. Where all elements are turned
/// the wrong way round they are turned over; nodes that no element uses are dropped. Both leave a message, as do
/// coincident nodes (within 1e-9 of the bounding box's diagonal) and a mesh in several parts.
///
/// @param order  1: corners only, also of quadratic cells. 2: nodes in the middle of edges as the file has them, or at
///               the middle of straight edges where its cells are linear
/// @throws InputError  with the file and its own element or node number: no cells of the family, several types of
///                     volume cells, a node twice in an element, flat, repeated, folded or overlapping elements, a
///                     mixture of orientations, edges with two middle nodes, coordinates that are not finite
ElementMesh element_mesh(const Mesh& mesh, ElementFamily family, int order);

}  // namespace fascia
