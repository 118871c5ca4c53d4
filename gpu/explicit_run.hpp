#pragma once

#include "core/solver/clock.hpp"
#include "core/solver/explicit_dynamics.hpp"
#include "gpu/explicit.hpp"
#include "gpu/run.hpp"

#include <cmath>
#include <utility>

/// The body of explicit runs, for the files that instantiate it.
namespace fascia::gpu {

/// A step whose velocities were reported.
template <class Space>
class ReachedExplicitStep : public DeviceStep {
 public:
  ReachedExplicitStep(ExplicitSystem<Space>& system, State& state) : system_(system), state_(state) {}
  InternalEnergy energy() const override { return system_.energy(); }
  const State& state() override {
    if (fetched_) return state_;
    State fetched = state_;
    system_.pose().download(fetched);
    state_ = std::move(fetched);
    fetched_ = true;
    return state_;
  }
  void show(MechanicalSystem& host, std::span<const double> factors) override {
    host.set_factors(factors);
    host.look_at(state(), system_.time_step());
    const std::vector<PoseMotion> accelerations = system_.held_accelerations();
    host.add_support_inertia([&](int node) { return accelerations[at(system_.constraint_of(node))]; });
  }

 private:
  ExplicitSystem<Space>& system_;
  State& state_;
  bool fetched_ = false;
};

/// As run_explicit() of the host. Whether the motion is sound is looked at every so many steps, and where the state is
/// seen or kept; the space remembers the step at which it was not.
template <class Space>
RunReport run_explicit_in(const Model& model, State& state, const FactorFunction& factors, const SolverSettings& solver,
                          const ExplicitSettings& settings, const DeviceObserver& observe) {
  constexpr int kLookEvery = 50;
  static_assert(kExplicitKeepEvery % kLookEvery == 0);
  const double begin = state.time;
  ExplicitSystem<Space> system(model, state, settings.time_step, factors);
  RunReport run;
  DeviceState<Space> good = system.pose();
  int good_step = 0;
  Clock::time_point start = Clock::now();
  for (int step = 1; step <= settings.steps; ++step) {
    system.advance();
    run.steps = step;
    run.time = begin + step * settings.time_step;
    const StepInfo info{step, run.time, static_cast<double>(step) / settings.steps, {}, seconds_since(start)};
    start = Clock::now();
    const bool last = step == settings.steps;
    const bool seen = last || (observe && (!settings.observed || settings.observed(info)));
    const bool kept = seen || step % kExplicitKeepEvery == 0;
    if (kept) system.report_velocities();
    if (!kept && step % kLookEvery != 0) continue;
    const auto progress = system.progress();
    if (progress.unsound > 0 || (kept && !std::isfinite(progress.motion))) {
      good.download(state);
      ThreadPool pool(0);
      MechanicalSystem host(model, pool, solver);
      run.status = RunStatus::diverged;
      run.message =
          explicit_divergence(host, state, progress.unsound > 0 ? progress.unsound : step, settings.time_step);
      run.time = state.time;
      run.steps = good_step;
      return run;
    }
    if (kept) good = system.pose();
    if (kept) good_step = step;
    if (!seen || !observe) continue;
    ReachedExplicitStep<Space> reached(system, state);
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
