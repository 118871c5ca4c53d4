#pragma once

#include "core/run/controlled_point.hpp"
#include "core/run/drivers.hpp"

#include <optional>
#include <vector>

namespace fascia {

/// How a static path is followed.
enum class PathControl {
  displacement,  ///< one displacement grows by prescribed increments
  arc_length     ///< the displacements of all nodes together move by prescribed lengths
};

struct PathSettings {
  PathControl control = PathControl::arc_length;
  int load_steps = 0;                         ///< the first step aims at the load factor 1/load_steps; 0: 1/10
  int max_steps = 500;                        ///< the run gives up there
  std::optional<ControlledPoint> controlled;  ///< displacement control without: the translation that answers most
};

/// Follows the path of equilibria from rest, the load factor λ being an unknown of every step, to where λ first is 1.
///
/// A step solves r(u, λ) = 0 together with p(u) = Δp by Newton's method on both (Riks 1979, Crisfield 1981; linearised
/// consistently, hence without the roots of a quadratic):
///
///   d = d_r + δλ d_f,   δλ = (Δp − p − p'·d_r) / (p'·d_f),   K d_r = −r,   K d_f = −∂r/∂λ
///
/// with p = |Δu| over the translations of all nodes (cylindrical arc length), or the controlled displacement. K is
/// factorised as it is, indefinite past a limit point. Steps grow and shrink with the number of iterations; they are
/// cut in half where Newton fails, or where the tangents at both ends do not explain the step (the path bends too far,
/// or another one was met), down to 1/1024 of the first. λ goes on the way that makes an angle below 90 degrees with
/// the step before, so that limit points are passed.
///
/// @param factors  of any λ, below 0 and above 1 too
RunReport run_path(MechanicalSystem& system, State& state, const FactorFunction& factors,
                   const SolverSettings& settings, const PathSettings& path, const StepObserver& observe);

/// True where load control came to a limit point: at the state the tangent is indefinite, or the loads move it several
/// times as easily as they did at rest. @param reached  load factor of the state
bool near_limit_point(MechanicalSystem& system, const State& state, const FactorFunction& factors, double reached);

}  // namespace fascia
