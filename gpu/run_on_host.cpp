#include "gpu/run_body.hpp"

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

}  // namespace fascia::gpu
