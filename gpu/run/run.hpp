#pragma once

#include "core/run/explicit_dynamics.hpp"
#include "core/run/model_stepper.hpp"

#include <functional>
#include <memory>

/// Runs of whole scenes on the device, for those who know nothing of spaces.
namespace fascia::gpu {

/// Called after each accepted step, and where DynamicsSettings ask for it at the start; returns false to stop. Copies
/// to the host what is asked of the step.
using DeviceObserver = std::function<bool(const StepInfo&, ReachedStep&)>;

/// run_statics() and run_implicit() with everything on the device. The state that was reached is copied back, also
/// where a step did not converge; where an error was thrown, it is the last one that was looked at.
/// @throws NoDevice, DeviceMemoryError, DeviceLost, NotShared
RunReport run_statics(const Model& model, State& state, const FactorFunction& factors, const SolverSettings& settings,
                      const StaticsSettings& statics, const DeviceObserver& observe);
RunReport run_implicit(const Model& model, State& state, const FactorFunction& factors, const SolverSettings& settings,
                       const DynamicsSettings& dynamics, const DeviceObserver& observe);

/// run_explicit() with everything on the device. Steps are queued: whether the motion is sound is looked at every few
/// of them, so that `observed` may be asked of steps after the one that is not, and the seconds of a step are what the
/// host waited for. What acts at a step that is seen is evaluated by a second system of the device, where it is asked
/// for; by one of the host where the device has no room for it.
/// @throws InputError  where a node has no inertia; and as above
RunReport run_explicit(const Model& model, State& state, const FactorFunction& factors, const SolverSettings& settings,
                       const ExplicitSettings& dynamics, const DeviceObserver& observe);

/// fascia::make_stepper() with everything on the device.
/// @throws NoDevice, DeviceMemoryError, DeviceLost, NotShared  also from its steps, but the first
std::unique_ptr<ModelStepper> make_stepper(const Model& model, const State& start, const SolverSettings& settings,
                                           const SteppingSettings& stepping);

/// Evaluation of a model at a state, for comparisons.
struct DeviceEvaluation {
  Evaluation judged;
  InternalEnergy energy;
  std::vector<double> gradient;  ///< as MechanicalSystem::gradient()
  std::vector<double> product;   ///< of the tangent with a direction
};

/// At rest loads of these factors, without inertia. @param direction  by degrees of freedom, in world axes
DeviceEvaluation evaluate(const Model& model, const State& state, std::span<const double> factors,
                          const SolverSettings& settings, std::span<const double> direction);

/// run_statics(), run_implicit(), run_explicit() and evaluate() in the space of the host: slow, and for tests of what
/// the device computes.
RunReport run_statics_on_host(const Model& model, State& state, const FactorFunction& factors,
                              const SolverSettings& settings, const StaticsSettings& statics,
                              const DeviceObserver& observe);
RunReport run_implicit_on_host(const Model& model, State& state, const FactorFunction& factors,
                               const SolverSettings& settings, const DynamicsSettings& dynamics,
                               const DeviceObserver& observe);
RunReport run_explicit_on_host(const Model& model, State& state, const FactorFunction& factors,
                               const SolverSettings& settings, const ExplicitSettings& dynamics,
                               const DeviceObserver& observe);
std::unique_ptr<ModelStepper> make_stepper_on_host(const Model& model, const State& start,
                                                   const SolverSettings& settings, const SteppingSettings& stepping);
DeviceEvaluation evaluate_on_host(const Model& model, const State& state, std::span<const double> factors,
                                  const SolverSettings& settings, std::span<const double> direction);

}  // namespace fascia::gpu
