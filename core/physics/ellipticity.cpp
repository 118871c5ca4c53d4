#include "core/physics/ellipticity.hpp"

#include "core/base/index.hpp"
#include "core/math/principal_axes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace fascia {

bool is_strongly_elliptic(const Lame& m, const Mat3d& F) {
  constexpr int kAngles = 18;
  const Mat3d C = transpose_times(F, F);
  if (!std::isfinite(contract(C, C))) return true;
  const PrincipalAxes c = principal_axes(C);  // of the stress too
  std::array<double, 3> stress{};
  for (int a = 0; a < 3; ++a) stress[at(a)] = 0.5 * m.lambda * (trace(C) - 3) + m.mu * (c.values[a] - 1);
  // Q is at least this times I.
  if (*std::min_element(stress.begin(), stress.end()) + m.mu * c.values[0] > 0) return true;
  const Mat3d shear = times_transpose(F, F) * m.mu;
  for (int plane = 0; plane < 3; ++plane)
    for (int k = 0; k < kAngles; ++k) {
      const double angle = std::numbers::pi * k / kAngles, cosine = std::cos(angle), sine = std::sin(angle);
      const int first = (plane + 1) % 3, second = (plane + 2) % 3;
      const Vec3d n = F * (c.axes[first] * cosine + c.axes[second] * sine);
      const double along = cosine * cosine * stress[at(first)] + sine * sine * stress[at(second)];
      const Mat3d Q = Mat3d::identity() * along + outer(n, n) * (m.lambda + m.mu) + shear;
      if (principal_axes(Q).values[0] < 0) return false;
    }
  return true;
}

}  // namespace fascia
