#pragma once

#include "core/model/model.hpp"
#include "core/solver/dof_filter.hpp"

#include <array>
#include <span>
#include <vector>

namespace fascia {

/// What the prescribed degrees of freedom still lack to where boundary motions take them, in constraint axes; zero in
/// the free ones. Vertices have no rotations to hold.
/// @param turned  as in State
void prescribed_increments(const Model& model, const DofFilter& filter, const State& state,
                           std::span<const std::array<double, 3>> turned, std::span<const double> factors,
                           std::span<double> local);

/// Moves a state by increments of its degrees of freedom: u + du, exp(dr) Q, A + dA, and counts turns about held axes.
/// @param global  in world axes
void move_state(const Model& model, std::span<const double> global, State& state);

/// Where tethers pull to: as CpuExecutor::targets().
void place_tethers(const Model& model, std::span<const double> factors, std::span<double> targets);

}  // namespace fascia
