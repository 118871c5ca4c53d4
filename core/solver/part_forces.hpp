#pragma once

#include "core/solver/verdict.hpp"
#include "core/step/step_view.hpp"

#include <cmath>
#include <limits>

namespace fascia {

/// All that judges a connected part beside the sums over its nodes.
struct PartSizes {
  double rounding = 0;     ///< that is left in the forces of its blocks [N]
  double of_surfaces = 0;  ///< likewise of surface loads [N]
  double tether = 0;       ///< square of the pull of tethers [N²]
  double leverage = 1;     ///< Dependents::leverage()
  double mass = 0;         ///< part_masses() [kg]
  bool driven = false;     ///< driven_parts()
};

/// The forces of a part in an implicit step.
/// @param q       sums over its nodes (kNodeQuantities)
/// @param h       of the step's form [s]; 0: statics
/// @param motion  returns the largest displacement of the part [m]; asked where nothing but inertia acts
template <class Motion>
PartForces part_forces(const double* q, const PartSizes& sizes, double h, const Motion& motion) {
  PartForces f{.residual = q[kResidual],
               .load = squared_load(q[kLoad], q[kTurnedLoad]),
               .inertia = q[kInertia],
               .reaction = q[kReaction],
               .tether = sizes.tether,
               .momentum = q[kCancelled]};
  // 4: sums of a few terms of the estimated size in each entry.
  const double cancelled = std::numeric_limits<double>::epsilon() * std::sqrt(q[kCancelled] + q[kTurnedLoad]);
  f.rounding = 4 * sizes.leverage * std::hypot(sizes.rounding, cancelled, sizes.of_surfaces);
  f.driven = sizes.driven;
  if (h <= 0 || f.load != 0 || f.reaction != 0 || f.tether != 0 || !(f.momentum > 0)) return f;
  const double still = kAtRest * sizes.mass * motion() / (h * h);
  f.adrift = f.momentum > still * still;
  return f;
}

}  // namespace fascia
