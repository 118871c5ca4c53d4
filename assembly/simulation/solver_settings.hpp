#pragma once

#include "assembly/specification/scene.hpp"
#include "core/node/time_scheme.hpp"
#include "core/run/drivers.hpp"
#include "core/run/explicit_plan.hpp"
#include "core/solver/settings.hpp"

namespace fascia {

/// What a scene's solver asks of Newton's method and the linear solver.
SolverSettings settings_of(const Solver& solver);

/// The time of a scene's implicit dynamics.
DynamicsSettings dynamics_of(const Solver& solver);
/// Of its explicit dynamics, once settle_time_step() was there. @param observed  as in ExplicitSettings
ExplicitSettings explicit_of(const Scene& scene, const std::function<bool(const StepInfo&)>& observed);

/// Implicit Euler where the solver has no scheme of its own.
TimeScheme scheme_of(SolverKind kind);

}  // namespace fascia
