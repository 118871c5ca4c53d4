#pragma once

#include "core/base/clock.hpp"
#include "core/base/index.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "core/solver/state_copies.hpp"

#include <cmath>
#include <memory>
#include <vector>

namespace fascia {

/// Runs the steps of a plan, in any space. Whether the motion is sound is looked at every so many steps
/// (System::kLookEvery), and where the state is seen or kept; the steps remember at which of them it was not.
///
/// @param system   an ExplicitSteps at the start
/// @param state    takes the end, or the last state that was good
/// @param watched  somebody watches: tell(info) shows a step whose velocities were reported; false ends the run
/// @param explain  explain(state, step, its end, plan) says why steps are not sound, from the last state that was
template <class System, class Tell, class Explain>
RunReport run_explicit_steps(System& system, State& state, const ExplicitSettings& settings, bool watched,
                             const Tell& tell, const Explain& explain) {
  static_assert(kExplicitKeepEvery % System::kLookEvery == 0);
  const ExplicitPlan& plan = system.plan();
  RunReport run;
  if (plan.automatic()) system.save();
  auto good = system.pose();
  int good_step = 0, retries = 0;
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
    const bool seen = last || (watched && (!settings.observed || settings.observed(info)));
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
    if (!kept && step % System::kLookEvery != 0 && !plan.collapsed()) continue;
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
      fetch_state(system.pose(), state);
      run.failed = std::make_shared<FailedState>(FailedState{state, {}, step});
      fetch_state(good, state);
      run.status = RunStatus::diverged;
      run.message = explain(state, failed, ends[ends.size() - 1 - at(step - failed)], plan);
      run.time = state.time;
      run.steps = good_step;
      return run;
    }
    ends.clear();
    if (kept) good = system.pose();
    if (kept) good_step = step;
    if (kept && plan.automatic()) system.save();
    if (kept) retries = 0;
    if (!seen || !watched) continue;
    if (!tell(info)) {
      if (!last) run.status = RunStatus::interrupted;
      break;
    }
    start = Clock::now();  // what the observer took is not the step's
  }
  fetch_state(system.pose(), state);
  return run;
}

}  // namespace fascia
