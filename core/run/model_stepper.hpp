#pragma once

#include "core/node/time_scheme.hpp"
#include "core/run/drivers.hpp"

#include <memory>
#include <string>
#include <vector>

namespace fascia {

/// How a model is stepped.
struct SteppingSettings {
  bool statics = false;  ///< equilibria, where time is the load factor
  TimeScheme scheme = TimeScheme::implicit_euler;
  int load_steps = 0;  ///< of each call in statics, 0: as few as converge
};

/// Everything that the steps after a moment depend on, beside the model.
struct SteppingSnapshot {
  State state;
  StepMemory memory;
  std::vector<double> pressures;  ///< Newton's, of enclosed volumes [Pa]
};

/// Takes the steps of a model one by one, on one processor or another. The model's motions may change between steps.
class ModelStepper {
 public:
  virtual ~ModelStepper() = default;

  /// Advances by dt [s]; in statics the load factor by dt.
  /// @param factors  of schedules during this step; those of driven motions go from 0 to 1
  /// @return  of this step alone. Where it did not converge the state is what it was, and the message says why
  virtual RunReport step(const FactorFunction& factors, double dt) = 0;

  /// Before the first step, where steps have a budget: see ImplicitStepper::warm_up().
  /// A model that is edited later is tried again. @return  a sentence where the budget holds no step
  virtual std::string warm_up(const FactorFunction& factors, double dt) = 0;

  virtual double time() const = 0;  ///< that was reached [s]; in statics the load factor

  /// The state that was reached. The host's steps change it in place; from a device it is fetched once a step.
  virtual const State& state() = 0;

  /// Reads what acts at that state: after a step as the step's equations have it; before the first one, and after a
  /// snapshot was taken or restored, that of the state at rest under these factors.
  virtual void read(const FactorFunction& factors, const ReachedParts& parts, ReachedForces& out) = 0;

  /// The model was edited (core/structure/edit.hpp): all that was made of it is made again, and the run goes on from
  /// the present state, with new nodes at rest.
  virtual void model_changed(const FactorFunction& factors) = 0;

  /// A state of which the steps to come depend on nothing that came before it: preconditioners are made anew.
  virtual SteppingSnapshot snapshot(const FactorFunction& factors) = 0;
  virtual void restore(const SteppingSnapshot& snapshot, const FactorFunction& factors) = 0;
};

/// On the threads of a pool. Model and pool stay with the caller.
std::unique_ptr<ModelStepper> make_stepper(const Model& model, const State& start, ThreadPool& pool,
                                           const SolverSettings& settings, const SteppingSettings& stepping);

}  // namespace fascia
