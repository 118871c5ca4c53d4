#pragma once

#include "core/solver/drivers.hpp"

#include <functional>
#include <string>

namespace fascia {

struct ExplicitSettings {
  double time_step = 0;  ///< [s]
  int steps = 0;
  /// Which steps the observer sees, besides the last; asked once after each step. Empty: all. Velocities at whole steps
  /// and the system's evaluation are made only for these.
  std::function<bool(const StepInfo&)> observed;
};

/// Dynamics by central differences, as a leap-frog: forces at whole steps, velocities at half steps,
///
///   v₊ = ((1 − α dt/2) v₋ + dt f/m) / (1 + α dt/2),   u ← u + dt v₊,
///
/// of rigid frames with the momentum about their mass centre, L₊ from L₋ and the torque, and the rotation exp(dt ω),
/// ω = I(exp(dt ω₀/2) Q)⁻¹ L, ω₀ = I(Q)⁻¹ L. Stiffness damping acts with the strain rate of the last half step.
/// Velocities that the observer sees are means of the half steps on both sides. The system's gradient is then what
/// look_at() says of them: the viscous stress is that of the state seen, to second order, not that of the half step
/// before; with what accelerated supports carry, without inertia elsewhere.
///
/// It stops with RunStatus::diverged and the last good state when the kinetic energy exceeds what loads and boundaries
/// can have given.
/// @throws InputError  where a node has no inertia
RunReport run_explicit(MechanicalSystem& system, State& state, const FactorFunction& factors,
                       const ExplicitSettings& settings, const StepObserver& observe);

/// The largest safe time step of central differences at a state [s]: kStableMargin · (2/ω)(√(1 + ξ²) − ξ), where ω is
/// the highest frequency on the free degrees of freedom, by Lanczos iterations, and ξ = β ω / 2 is its stiffness
/// damping (which may differ from point to point). Infinite where nothing is stiff.
/// @throws InputError  where a node has no inertia
double stable_time_step(MechanicalSystem& system, const State& state);
/// At rest, where a run begins.
double stable_time_step(MechanicalSystem& system);

/// What is kept of the limit: the material stiffens where it is stretched, and iterations find ω from below.
inline constexpr double kStableMargin = 0.95;

/// A run keeps its state every so many steps, to return to where it blows up.
inline constexpr int kExplicitKeepEvery = 100;

/// Why a run stops at a step. @param good  the last state kept
std::string explicit_divergence(MechanicalSystem& system, const State& good, int step, double dt);

/// @throws InputError  where a free motion of a node has no inertia
void require_inertia(const Model& model, const DofFilter& filter);

}  // namespace fascia
