#pragma once

#include "core/math/mat3.hpp"

namespace fascia {

/// S = Σ value axis axisᵀ of a symmetric matrix.
struct PrincipalAxes {
  Vec3d values;   ///< ascending
  Vec3d axes[3];  ///< orthonormal
};

/// Reads the lower triangle of S.
PrincipalAxes principal_axes(const Mat3d& S);

}  // namespace fascia
