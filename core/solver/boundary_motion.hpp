#pragma once

#include "core/node/prescribed.hpp"
#include "core/structure/model.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace fascia {

/// Sizes that rounding of prescribed increments is judged by: of displacements [m] and of rotations [rad], as far as
/// the model's boundary motions say.
struct MotionSizes {
  double displacement = 0, angle = 1;

  /// More is left than rounding. @param left  as PrescribedLeft sums it up (3)
  bool lacks(const double* left) const {
    return left[1] > 1e-14 * std::max(left[0], displacement) || left[2] > 1e-14 * angle;
  }
};
MotionSizes motion_sizes(const Model& model);

/// Fills factors of all schedules at rest (all zero).
std::vector<double> zero_factors(const Model& model);

/// Largest rotation [rad] by which a boundary motion would turn a frame.
/// @param turned  as in State, now
/// @param reached  factors at the end of the last step
double prescribed_rotation(const Model& model, std::span<const std::array<double, 3>> turned,
                           std::span<const double> factors, std::span<const double> reached);

/// Sets the factors of motions that a driver gives anew to their start, 0.
void start_driven(const Model& model, std::vector<double>& factors);

/// Takes from the velocities of a state what constraints hold still. What motions move keeps its own.
void stop_held(const Model& model, State& state);

/// Where all tethers pull to: as CpuExecutor::targets().
void place_tethers(const Model& model, std::span<const double> factors, std::span<double> targets);

}  // namespace fascia
