#pragma once

#include "core/body/model_body.hpp"

#include <array>
#include <vector>

namespace fascia {

/// A face of a body by points of its surface, as face_rule() orders them.
using BodyFace = std::vector<int>;

/// Edges, from one corner to the next, that no other face runs through the other way.
std::vector<std::array<int, 2>> free_edges(const std::vector<BodyFace>& faces);

/// The faces in parts that hang together across edges.
std::vector<std::vector<BodyFace>> connected_faces(const std::vector<BodyFace>& faces);

/// The faces, each seen from its other side.
std::vector<BodyFace> turned_over(const std::vector<BodyFace>& faces);

/// Faces of a body as a surface that its nodes move, without pressure; measured at rest. Triangles whose corners are
/// moved by several nodes each get vertices in the middle of their edges: quadratic, as products of weights along a
/// face are.
SurfaceLoad surface_of(const ModelBody& body, const std::vector<BodyFace>& faces);

}  // namespace fascia
