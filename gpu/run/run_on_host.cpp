#include "gpu/run/explicit_run.hpp"
#include "gpu/run/run_body.hpp"

namespace fascia::gpu {

RunReport run_statics_on_host(const Model& model, State& state, const FactorFunction& factors,
                              const SolverSettings& settings, const StaticsSettings& statics,
                              const DeviceObserver& observe) {
  return run_statics_in<HostSpace>(model, state, factors, settings, statics, observe);
}

RunReport run_implicit_on_host(const Model& model, State& state, const FactorFunction& factors,
                               const SolverSettings& settings, const DynamicsSettings& dynamics,
                               const DeviceObserver& observe) {
  return run_implicit_in<HostSpace>(model, state, factors, settings, dynamics, observe);
}

RunReport run_explicit_on_host(const Model& model, State& state, const FactorFunction& factors,
                               const SolverSettings& settings, const ExplicitSettings& dynamics,
                               const DeviceObserver& observe) {
  return run_explicit_in<HostSpace>(model, state, factors, settings, dynamics, observe);
}

std::unique_ptr<ModelStepper> make_stepper_on_host(const Model& model, const State& start,
                                                   const SolverSettings& settings, const SteppingSettings& stepping) {
  return make_stepper_in<HostSpace>(model, start, settings, stepping);
}

DeviceEvaluation evaluate_on_host(const Model& model, const State& state, std::span<const double> factors,
                                  const SolverSettings& settings, std::span<const double> direction) {
  return evaluate_in<HostSpace>(model, state, factors, settings, direction);
}

}  // namespace fascia::gpu
