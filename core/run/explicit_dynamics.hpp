#pragma once

#include "core/run/drivers.hpp"
#include "core/run/explicit_plan.hpp"

#include <limits>
#include <string>
#include <vector>

namespace fascia {

/// Dynamics by central differences, as a leap-frog: forces at whole steps, velocities at half steps,
///
///   v₊ = ((1 − α dt/2) v₋ + dt f/m) / (1 + α dt/2),   u ← u + dt v₊,
///
/// where steps are unequal with the mean of both, (dt₋ + dt₊)/2, in the place of dt in v₊ (ExplicitPlan has the steps),
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

/// The motion that limits the time step of central differences: that of the highest frequency.
struct LimitingMotion {
  double step = std::numeric_limits<double>::infinity();      ///< stable_time_step() [s]
  double undamped = std::numeric_limits<double>::infinity();  ///< the same without stiffness damping [s]
  std::vector<double> motion;   ///< by degrees of freedom in world axes; empty: nothing is stiff
  std::vector<double> kinetic;  ///< each node's part of its kinetic energy; 1 in all
};

/// It costs twice what stable_time_step() does. @throws InputError  where a node has no inertia
LimitingMotion limiting_motion(MechanicalSystem& system, const State& state);

/// A run keeps its state every so many steps, to return to where it blows up.
inline constexpr int kExplicitKeepEvery = 100;

/// So many times in a row automatic steps are taken again before a run counts as blown up.
inline constexpr int kExplicitRetries = 10;

/// Why a run stops at a step of a plan. @param good  the last state kept
std::string explicit_divergence(MechanicalSystem& system, const State& good, int step, double time,
                                const ExplicitPlan& plan);

/// @throws InputError  where muscle acts, whose work explicit steps do not count
void refuse_active_stress(const Model& model);

/// @throws InputError  where a free motion of a node has no inertia
void require_inertia(const Model& model, const DofFilter& filter);

}  // namespace fascia
