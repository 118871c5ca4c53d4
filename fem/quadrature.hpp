#pragma once

#include "fem/element_shape.hpp"

#include <vector>

namespace fascia {

/// Points of any rule: 3 × 3 × 3.
inline constexpr int kMostRulePoints = 27;

/// A point of a rule on the reference element, with the shape functions of the rule's elements there.
struct QuadraturePoint {
  Vec3d xi{};
  double weight = 0;    ///< the weights add up to the reference volume: tetrahedron 1/6, hexahedron 8
  ShapeValues N{};      ///< [-]
  ShapeGradients dN{};  ///< dN/dξ [-]
};

/// The rule of full integration of a shape: tet4 one point (exact for degree 1), tet10 four (degree 2), hex8 2×2×2
/// Gauss points (degree 3 along each axis), hex20 3×3×3 (degree 5 along each axis); ξ runs fastest. It stays for ever.
const std::vector<QuadraturePoint>& quadrature(ElementShape shape);

}  // namespace fascia
