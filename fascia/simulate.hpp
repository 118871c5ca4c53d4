#pragma once

#include "core/run/run_status.hpp"
#include "fascia/backend.hpp"
#include "fascia/rows.hpp"
#include "fascia/scene.hpp"

#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

/// Whole runs: statics, paths past limit points, implicit and explicit dynamics, modes.
namespace fascia {

struct Simulation;
struct ProbedState;

/// A state that a run shows; it is valid during the call that gets it. Shapes of modes are scaled so that the largest
/// displacement is a tenth of the largest body.
class RunState {
 public:
  double time() const { return time_; }  ///< [s]; of statics and paths the load factor, of modes the number of the mode
  Rows rest_positions() const;           ///< of the nodes of all bodies (nodes × 3) [m]
  Rows displacements() const;            ///< (nodes × 3) [m]
  Rows velocities() const;               ///< (nodes × 3) [m/s]
  /// The value of a probe of the scene: one number, 3, 9 by rows, or as many for each of its places; always finite.
  /// @throws InputError  the scene has none of this name
  std::vector<double> probe(std::string_view name) const;

 private:
  friend class RunStates;
  RunState(double time, const Simulation& simulation, const ProbedState& at,
           const std::vector<std::vector<double>>& values)
      : time_(time), simulation_(simulation), at_(at), values_(values) {}

  double time_;
  const Simulation& simulation_;
  const ProbedState& at_;
  const std::vector<std::vector<double>>& values_;
};

/// How a run went.
struct RunOutcome {
  RunStatus status = RunStatus::converged;
  bool done = true;     ///< it came to its end: it converged, or took steps above the tolerance as the scene asks for
  std::string message;  ///< what went wrong, where, and what to try; empty where nothing did
  double time = 0;      ///< that was reached [s]; of statics and paths the load factor
  double seconds = 0;   ///< that the solution took, without set-up
  double residual = 0;  ///< largest that a step left, as a part of the forces that act [-]
  int steps = 0, newton_iterations = 0, linear_iterations = 0;
  Backend backend = Backend::cpu;     ///< that took the steps
  int gpus = 0;                       ///< that shared them
  std::vector<std::string> warnings;  ///< sentences on what should be known of the scene and of its result
  std::vector<std::string> doubts;    ///< why another run may find another solution
  std::vector<double> frequencies;    ///< of modes [Hz]
};

/// Runs a scene from start to end, with the steps of `fascia run`, and writes nothing.
///
/// Dynamic kinds need Solver::time_step, and Solver::steps or Solver::duration; explicit ones may have
/// Solver::time_step_automatic and a duration. With Solver::backend = "auto" large scenes take a GPU where there is
/// one. A run whose probes have a value that is not finite ends as diverged before the state is shown.
/// @param look  called at each state that the program has a row of probes for: of statics each load step, of paths each
///              point, of dynamics the start, the states that Output::every or every_steps choose (25 a simulated
///              second where both are left out) and the last, of modes each shape. Where it returns false the run is
///              interrupted, unless that was the last state. What it throws leaves simulate().
/// @param stop  asked before each iteration of Newton's method, and after each step and shape: a run that is told to
///              stop is interrupted, at the last step that it finished, and shows that state
/// @throws SceneError    what is wrong with the scene: the place is the key of the field
/// @throws FileError, InputError  meshes; more than memory or a GPU can number
/// @throws BackendError  a GPU that was asked for and is not there, has too little memory, or does not compute the
/// scene
/// @throws StateError    a mode with a value that is not finite
RunOutcome simulate(Scene scene, const std::function<bool(const RunState&)>& look = {},
                    const std::stop_token& stop = {});

}  // namespace fascia
