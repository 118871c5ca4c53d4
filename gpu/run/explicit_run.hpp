#pragma once

#include "core/run/explicit_run.hpp"
#include "gpu/explicit/explicit.hpp"
#include "gpu/run/run.hpp"
#include "gpu/space/device.hpp"
#include "gpu/system/host_system.hpp"
#include "gpu/system/system.hpp"

#include <optional>
#include <utility>

/// The body of explicit runs, for the files that instantiate it.
namespace fascia::gpu {

/// Looks at what acts at states of an explicit run, by a system beside it, which is made when it is first asked for:
/// steps know neither energies of blocks nor what supports carry. Where the space has no room for it, the host looks.
template <class Space>
class ExplicitLooker {
 public:
  ExplicitLooker(const Model& model, const FactorFunction& factors, const SolverSettings& settings)
      : model_(model), factors_(factors), settings_(settings) {}

  /// Reads the state that the run has reached, with velocities. @param dt  of the step that led there [s]
  void read(const ExplicitSystem<Space>& run, const State& state, double dt, const ReachedParts& parts,
            ReachedForces& out) {
    if (!host_) {
      try {
        return read_in_space(run, state, dt, parts, out);
      } catch (const DeviceMemoryError&) {
        system_.reset();
      }
      host_.emplace(model_, settings_);
    }
    host_->system.set_factors(factors_(state.time));
    host_->system.look_at(state, dt);
    host_->system.add_held_inertia(run.held_accelerations().downloaded());
    host_->system.read(parts, state, out);
  }

 private:
  void read_in_space(const ExplicitSystem<Space>& run, const State& state, double dt, const ReachedParts& parts,
                     ReachedForces& out) {
    if (!system_) {
      SolverSettings settings;
      settings.preconditioner = PreconditionerKind::jacobi;  // no tiles, which only solves need
      system_.emplace(model_, settings);
    }
    system_->set_factors(factors_(state.time));
    system_->look_at(run.pose(), dt);
    system_->add_held_inertia(run.held_accelerations());
    system_->read(parts, out);
    if (parts.forces) read_tethers(model_, system_->tether_targets(), state, out);
  }

  const Model& model_;
  const FactorFunction& factors_;
  const SolverSettings& settings_;
  std::optional<System<Space>> system_;
  std::optional<HostSystem> host_;
};

/// A step whose velocities were reported.
template <class Space>
class ReachedExplicitStep final : public ReachedStep {
 public:
  /// @param dt  of the step that led there [s]
  ReachedExplicitStep(ExplicitSystem<Space>& system, ExplicitLooker<Space>& looker, State& state, double dt)
      : system_(system), looker_(looker), state_(state), dt_(dt) {}
  InternalEnergy energy() const override { return system_.energy(); }
  const State& state() override {
    if (fetched_) return state_;
    State fetched = state_;
    system_.pose().download(fetched);
    state_ = std::move(fetched);
    fetched_ = true;
    return state_;
  }
  void read(const ReachedParts& parts, ReachedForces& out) override {
    if (parts.any()) looker_.read(system_, state(), dt_, parts, out);
  }

 private:
  ExplicitSystem<Space>& system_;
  ExplicitLooker<Space>& looker_;
  State& state_;
  double dt_;
  bool fetched_ = false;
};

/// run_explicit() in a space.
template <class Space>
RunReport run_explicit_in(const Model& model, State& state, const FactorFunction& factors, const SolverSettings& solver,
                          const ExplicitSettings& settings, const DeviceObserver& observe) {
  ExplicitSystem<Space> system(model, state, ExplicitPlan(settings, state.time), factors);
  ExplicitLooker<Space> looker(model, factors, solver);
  return run_explicit_steps(
      system, state, settings, observe != nullptr,
      [&](const StepInfo& info) {
        ReachedExplicitStep<Space> reached(system, looker, state, info.time_step);
        return observe(info, reached);
      },
      [&](const State& good, int step, double time, const ExplicitPlan& plan) {
        HostSystem host(model, solver);
        host.system.set_factors(factors(good.time));
        return explicit_divergence(host.system, good, step, time, plan);
      });
}

}  // namespace fascia::gpu
