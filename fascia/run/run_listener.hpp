#pragma once

#include "assembly/simulation/probe_values.hpp"
#include "assembly/simulation/simulation.hpp"
#include "core/run/drivers.hpp"
#include "fascia/backend.hpp"

#include <vector>

namespace fascia {

/// Takes what a run hands over on its way. All calls come from the thread that runs.
class RunListener {
 public:
  virtual ~RunListener() = default;
  /// Says that the run is to end. It is asked after each step and after each state that was shown, sometimes twice.
  virtual bool stops() { return false; }
  /// Says that it is to end now, without the step under way. It is asked before each iteration of Newton's method.
  virtual bool leaves_step() { return false; }
  /// All is set up, and steps follow; not of modes.
  virtual void begins() {}
  /// Before each iteration of Newton's method.
  virtual void iterating(const IterationInfo&) {}
  /// After each step, shown or not.
  virtual void stepped(const StepInfo&) {}
  /// The fields of a state that is saved: the start, of dynamics the states that the scene's output asks for and the
  /// last, of statics and paths likewise, of modes each shape. The row of the state follows, but where a run of statics
  /// that broke off saves its last state again.
  /// @param number  load factor, time [s], of a path its step, of modes the number of the mode
  /// @throws StateError  a state with values that nothing can show: the run ends as diverged; of modes it goes on
  ///                     to the caller
  virtual void save(double number, const State& state) { (void)number, (void)state; }
  /// A row of probes: at each state that is saved, of statics and paths at each step.
  /// @param time    load factor, time [s], number of the mode
  /// @param values  of all probes, finite
  virtual void show(double time, const ProbedState& at, const ProbeValues& values) = 0;
  /// Warnings that are worth telling before the run goes on.
  virtual void warned(Warnings&) {}
  /// No step follows, though the last state may be saved yet; not of modes.
  /// @param choice  of the linear solver; null where the processor solved no system
  virtual void ended(const SolverChoice* choice) { (void)choice; }
};

/// The end of a run, and all that is known there.
struct RunEnd {
  RunReport report;
  Backend backend = Backend::cpu;  ///< that took the steps
  int gpus = 0;                    ///< that shared them
  State state;
  bool shown = true;     ///< false: the state has values that nothing can show
  bool failed = false;   ///< more than steps that were accepted as they were
  ReachedForces acting;  ///< at the state that was shown last, the parts that needed_parts() says
  Warnings warnings;
  double stabilization = 0;         ///< energy of stabilisation [J]
  std::vector<double> frequencies;  ///< of modes [Hz]
  /// [s]; `processor` is of the solve, of all threads.
  double setup_seconds = 0, solve_seconds = 0, output_seconds = 0, processor_seconds = 0;

  /// It came to its end, with whatever tolerance the scene asks for.
  bool done() const {
    const bool accepted = report.steps_at_limit > 0 || report.steps_out_of_time > 0;
    return report.status == RunStatus::converged || (accepted && !failed);
  }
};

}  // namespace fascia
