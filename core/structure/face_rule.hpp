#pragma once

#include <array>
#include <span>

namespace fascia {

/// Most nodes of a face: a quadrilateral with middle nodes.
inline constexpr int kMostFaceNodes = 8;

/// A quadrature point of a reference face: shape functions and their derivatives along two directions s, t with
/// s × t outward.
struct FaceRulePoint {
  double weight = 0;  ///< they add up to the area of the reference face
  std::array<double, kMostFaceNodes> N{}, ds{}, dt{};
};

/// Triangles of 3 or 6 nodes, quadrilaterals of 4 or 8 (serendipity): corners counter-clockwise seen from outside, then
/// the middle nodes of edges 01 12 .. The rule is exact for x · (∂x/∂s × ∂x/∂t) times a linear function of x, that is
/// for the volume, the weight of what fills it, and the derivatives of both.
std::span<const FaceRulePoint> face_rule(int nodes);

}  // namespace fascia
