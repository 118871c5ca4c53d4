#pragma once

#include "core/run/run_status.hpp"
#include "fascia/backend.hpp"
#include "fascia/rows.hpp"
#include "fascia/scene.hpp"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

/// Whole runs: statics, paths past limit points, implicit and explicit dynamics, modes.
namespace fascia {

struct Simulation;
struct ProbedState;

/// A state that a run shows, as long as the call lasts that gets it.
class RunState {
 public:
  RunState(double time, const Simulation& simulation, const ProbedState& at)
      : time_(time), simulation_(simulation), at_(at) {}

  double time() const { return time_; }  ///< [s]; of statics and paths the load factor, of modes the number of the mode
  Rows rest_positions() const;           ///< of the nodes of all bodies (nodes × 3) [m]
  Rows displacements() const;            ///< (nodes × 3) [m]
  Rows velocities() const;               ///< (nodes × 3) [m/s]
  /// The value of a probe of the scene: one number, 3, 9 by rows, or as many for each of its places.
  /// @throws InputError  the scene has none of this name
  /// @throws StateError  a value is not finite; unless the caller catches it, the run ends as diverged
  std::vector<double> probe(std::string_view name) const;

 private:
  double time_;
  const Simulation& simulation_;
  const ProbedState& at_;
};

/// How a run went.
struct RunOutcome {
  RunStatus status = RunStatus::converged;
  std::string message;  ///< what went wrong, where, and what to try; empty where nothing did
  double time = 0;      ///< that was reached [s]; of statics and paths the load factor
  double seconds = 0;   ///< that the solution took
  double residual = 0;  ///< largest of the steps, of what acts [-]
  int steps = 0, newton_iterations = 0, linear_iterations = 0;
  Backend backend = Backend::cpu;     ///< that took the steps
  int gpus = 0;                       ///< that shared them
  std::vector<std::string> warnings;  ///< sentences on what should be known of the scene and of its result
  std::vector<std::string> doubts;    ///< why another run may find another solution
  std::vector<double> frequencies;    ///< of modes [Hz]
};

/// Runs a scene from start to end, as `fascia run` does, and writes nothing.
/// @param look  called at each state that the program would have a row of probes for: of statics each load step, of
///              paths each point, of dynamics the start of explicit ones and what Output::every or every_steps choose,
///              and the last, of modes each shape. Where it returns false the run is interrupted.
/// @throws SceneError    what is wrong with the scene: the place is the key of the field
/// @throws FileError, InputError  meshes
/// @throws BackendError  a GPU that was asked for and is not there, or does not compute the scene
RunOutcome simulate(Scene scene, const std::function<bool(const RunState&)>& look = {});

}  // namespace fascia
