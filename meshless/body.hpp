#pragma once

#include "core/body/model_body.hpp"

#include <functional>

namespace fascia {

/// What a body is made of and how it is discretised, whatever its frames.
struct BodyMatter {
  bool affine = false;                                      ///< frames of 12 degrees of freedom
  bool half_blend = true;                                   ///< the paper's rule otherwise
  double stabilization = 0.1;                               ///< γ/μ
  double density = 0;                                       ///< [kg/m³]
  std::function<PointMaterialSpec(const Vec3d&)> material;  ///< by rest position
};

/// Lever and gradient of a frame with weight w and gradient g: half of its rotation acts along the directions in which
/// the weights reproduce linear fields (docs/notation.md).
/// @param halved  projector Π on these directions; 0: the paper's rule
/// @param d       place on the matter's middle minus frame, at rest
/// @param offset  material point minus that place, across the matter
inline Influence blended(double w, const Vec3d& g, const Mat3d& halved, const Vec3d& d, const Vec3d& offset = {}) {
  const Mat3d M = Mat3d::identity() - halved * 0.5;
  const Vec3d lever = M * d + offset;
  return {w, g, lever * w, outer(lever, g) + M * w};
}

}  // namespace fascia
