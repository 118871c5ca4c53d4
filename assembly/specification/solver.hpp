#pragma once

#include "assembly/specification/region.hpp"
#include "core/math/vec3.hpp"
#include "core/tangent/linear_settings.hpp"

#include <optional>
#include <string>

/// How a scene is solved.
namespace fascia {

enum class SolverKind { statics, implicit_euler, bdf2, newmark, midpoint, central_differences, modes };
constexpr bool is_implicit_dynamics(SolverKind kind) {
  return kind == SolverKind::implicit_euler || kind == SolverKind::bdf2 || kind == SolverKind::newmark ||
         kind == SolverKind::midpoint;
}
constexpr bool is_dynamic(SolverKind kind) {
  return is_implicit_dynamics(kind) || kind == SolverKind::central_differences;
}

enum class OnLimit { stop, proceed };

enum class StaticControl { load, displacement, arc_length };

/// The displacement that control = "displacement" prescribes.
struct ControlledDisplacement {
  std::string body{};
  Vec3d at{};  ///< rest position [m]
  Place at_place{};
  Vec3d direction{};
  std::optional<double> to{};  ///< [m]
};

struct Solver {
  Place place{};
  SolverKind kind = SolverKind::statics;
  double time_step = 0;  ///< [s]; 0 where it is automatic
  Place time_step_place{};
  bool time_step_automatic = false;  ///< central differences: a safe fraction of the stable step, and `steps` is open
  int steps = 0;                     ///< dynamic kinds: from `steps`, or duration / time_step rounded up
  std::optional<double> duration{};  ///< [s], where it was given
  int load_steps = 0;                ///< 0: automatic
  StaticControl control = StaticControl::load;
  std::optional<ControlledDisplacement> controlled{};
  int max_steps = 500;  ///< of a path that is followed
  int modes = 10;
  int newton_max_iterations = 50;
  double newton_tolerance = 1e-8;
  OnLimit on_limit = OnLimit::stop;
  std::optional<double> budget{};  ///< of implicit dynamics: time on the clock that a step may take [s]
  LinearMethod linear = LinearMethod::automatic;
  PreconditionerKind preconditioner = PreconditionerKind::automatic;
  int linear_max_iterations = 1000;
  double linear_tolerance = 1e-6;
  bool full_tangent = true;
  double imperfection = 0;  ///< of statics: part of the largest body by which the lowest mode bends it
  Place imperfection_place{};
  bool accept_unstable = false, accept_inverted = false;  ///< ends of statics that count as converged all the same
  std::string precision = "double";                       ///< "double", "mixed", "single"
  std::string backend = "auto";                           ///< "auto", "cpu", "cuda"
  int gpus = 1;
  int threads = 0;
  bool step_open = false;    ///< time_step is left out, under a need
  bool scheme_open = false;  ///< kind is left out beside a duration, under a need
};

}  // namespace fascia
