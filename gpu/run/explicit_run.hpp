#pragma once

#include "core/base/clock.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "gpu/explicit/explicit.hpp"
#include "gpu/run/run.hpp"
#include "gpu/space/device.hpp"
#include "gpu/system/host_system.hpp"
#include "gpu/system/system.hpp"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

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

/// Explicit dynamics in a space, like run_explicit() of the host. Whether the motion is sound is looked at every so
/// many steps, and where the state is seen or kept; the space remembers the step at which it was not.
template <class Space>
RunReport run_explicit_in(const Model& model, State& state, const FactorFunction& factors, const SolverSettings& solver,
                          const ExplicitSettings& settings, const DeviceObserver& observe) {
  constexpr int kLookEvery = 50;
  static_assert(kExplicitKeepEvery % kLookEvery == 0);
  ExplicitSystem<Space> system(model, state, ExplicitPlan(settings, state.time), factors);
  const ExplicitPlan& plan = system.plan();
  RunReport run;
  if (plan.automatic()) system.save();
  DeviceState<Space> good = system.pose();
  int good_step = 0, retries = 0;
  ExplicitLooker<Space> looker(model, factors, solver);
  std::vector<double> ends;  // of the steps since the motion was looked at
  Clock::time_point start = Clock::now();
  while (!plan.done()) {
    const double dt = plan.step();
    system.advance();
    const int step = plan.taken();
    const double time = plan.time();
    ends.push_back(time);
    const StepInfo info{step, time, plan.progress(), {}, seconds_since(start), dt};
    start = Clock::now();
    const bool last = plan.done();
    const bool seen = last || (observe && (!settings.observed || settings.observed(info)));
    const bool looks = plan.asks() || (seen && plan.automatic());
    if (looks) {
      const double stable = system.progress().unsound == 0 ? system.stable_step() : 0;
      if (plan.overruns(stable) && !plan.collapsed() && retries < kExplicitRetries) {
        system.restore(stable > 0 ? kStableMargin * stable : 0.5 * plan.limit());
        ends.clear();
        ++retries;
        continue;
      }
      if (stable > 0) system.adopt(stable);
    }
    run.steps = step;
    run.time = time;
    const bool kept = plan.automatic() ? looks : seen || step % kExplicitKeepEvery == 0;
    if (kept) system.report_velocities();
    if (!kept && step % kLookEvery != 0 && !plan.collapsed()) continue;
    const auto progress = system.progress();
    const bool sound = progress.unsound == 0 && !(kept && !std::isfinite(progress.motion));
    if (!sound && plan.automatic() && retries < kExplicitRetries) {
      system.restore(0.5 * plan.limit());
      ends.clear();
      ++retries;
      continue;
    }
    if (!sound || plan.collapsed()) {
      const int failed = progress.unsound > 0 ? progress.unsound : step;
      system.pose().download(state);
      run.failed = std::make_shared<FailedState>(FailedState{state, {}, step});
      good.download(state);
      run.status = RunStatus::diverged;
      HostSystem host(model, solver);
      host.system.set_factors(factors(state.time));
      run.message = explicit_divergence(host.system, state, failed, ends[ends.size() - 1 - at(step - failed)], plan);
      run.time = state.time;
      run.steps = good_step;
      return run;
    }
    ends.clear();
    if (kept) good = system.pose();
    if (kept) good_step = step;
    if (kept && plan.automatic()) system.save();
    if (kept) retries = 0;
    if (!seen || !observe) continue;
    ReachedExplicitStep<Space> reached(system, looker, state, dt);
    if (!observe(info, reached)) {
      if (!last) run.status = RunStatus::interrupted;
      break;
    }
    start = Clock::now();  // what the observer took is not the step's
  }
  system.pose().download(state);
  return run;
}

}  // namespace fascia::gpu
