#pragma once

#include "core/run/drivers_body.hpp"
#include "core/run/system_stepper.hpp"
#include "gpu/run/run.hpp"
#include "gpu/space/device.hpp"
#include "gpu/system/system.hpp"

/// The bodies of runs, for the files that instantiate them.
namespace fascia::gpu {

/// True where load control came to a limit point, as a MechanicalSystem of the host finds it; false for more than
/// System::kMostOfFactor free degrees of freedom.
template <class Space>
bool near_limit_point(System<Space>& system, const DeviceState<Space>& pose, const FactorFunction& factors,
                      double reached) {
  if (system.model().free_dof_count() > System<Space>::kMostOfFactor) return false;
  State state = State::at_rest(system.model());
  pose.download(state);
  return fascia::near_limit_point(system.host(), state, factors, reached);
}

/// Stability of the equilibrium at the end of statics: by a factorisation on the host where that is cheap, as of a
/// MechanicalSystem; else by conjugate gradients on the device.
template <class Space>
Stability end_stability(System<Space>& system, const DeviceState<Space>& end, const RunReport& run, bool) {
  const Model& model = system.model();
  if (model.free_dof_count() > System<Space>::kMostOfFactor) return system.stability(end);
  State state = State::at_rest(model);
  end.download(state);
  MechanicalSystem& host = system.host();
  host.set_factors(system.factors());
  host.begin_step(state, 0);
  host.evaluate();
  return host.stability(state, run.linear_iterations, false);
}

template <class Space>
class StepOfSystem final : public ReachedStep {
 public:
  /// @param fetched  `state` is that of `pose`
  StepOfSystem(System<Space>& system, const DeviceState<Space>& pose, State& state, bool fetched = false)
      : system_(system), pose_(pose), state_(state), fetched_(fetched) {}
  InternalEnergy energy() const override { return system_.internal_energy(); }
  const State& state() override {
    if (fetched_) return state_;
    State fetched = state_;
    pose_.download(fetched);
    state_ = std::move(fetched);
    fetched_ = true;
    return state_;
  }
  void read(const ReachedParts& parts, ReachedForces& out) override {
    system_.read(parts, out);
    if (parts.forces) read_tethers(system_.model(), system_.tether_targets(), state(), out);
  }

 private:
  System<Space>& system_;
  const DeviceState<Space>& pose_;
  State& state_;
  bool fetched_;
};

/// Calls run(system, pose, observer) with the state in the space, and brings it back.
template <class Space, class Run>
RunReport run_in(const Model& model, State& state, const SolverSettings& settings, const DeviceObserver& observe,
                 const Run& run) {
  System<Space> system(model, settings);
  DeviceState<Space> pose(state);
  const ObserverOf<System<Space>> watch = [&](const StepInfo& info, const DeviceState<Space>& reached,
                                              System<Space>& at) {
    StepOfSystem<Space> step(at, reached, state);
    return observe(info, step);
  };
  RunReport report = run(system, pose, observe ? watch : ObserverOf<System<Space>>{});
  pose.download(state);
  return report;
}

template <class Space>
RunReport run_statics_in(const Model& model, State& state, const FactorFunction& factors,
                         const SolverSettings& settings, const StaticsSettings& statics,
                         const DeviceObserver& observe) {
  return run_in<Space>(model, state, settings, observe, [&](auto& system, auto& pose, const auto& watch) {
    return fascia::run_statics(system, pose, factors, settings, statics, watch);
  });
}

/// @throws NotShared  what several GPUs do not compute together
inline void require_shared(const Model& model, const SolverSettings& settings, TimeScheme scheme) {
  // Tiles know the strains of one state before, and no others.
  if (settings.devices.size() > 1 && model.points.damped && scheme != TimeScheme::implicit_euler)
    throw NotShared("several GPUs share stiffness damping with kind = \"implicit-euler\" alone");
}

template <class Space>
RunReport run_implicit_in(const Model& model, State& state, const FactorFunction& factors,
                          const SolverSettings& settings, const DynamicsSettings& dynamics,
                          const DeviceObserver& observe) {
  require_shared(model, settings, dynamics.scheme);
  return run_in<Space>(model, state, settings, observe, [&](auto& system, auto& pose, const auto& watch) {
    return fascia::run_implicit(system, pose, factors, settings, dynamics, watch);
  });
}

template <class Space>
std::unique_ptr<ModelStepper> make_stepper_in(const Model& model, const State& start, const SolverSettings& settings,
                                              const SteppingSettings& stepping) {
  if (!stepping.statics) require_shared(model, settings, stepping.scheme);
  return std::make_unique<SystemStepper<System<Space>, StepOfSystem<Space>>>(model, start, settings, stepping);
}

template <class Space>
DeviceEvaluation evaluate_in(const Model& model, const State& state, std::span<const double> factors,
                             const SolverSettings& settings, std::span<const double> direction) {
  System<Space> system(model, settings);
  system.set_factors(factors);
  system.begin_step(DeviceState<Space>(state), 0);
  DeviceEvaluation out;
  out.judged = system.evaluate();
  out.energy = system.internal_energy();
  out.gradient = system.gradient();
  out.product = system.product(direction);
  return out;
}

}  // namespace fascia::gpu
