#include "app/bench/benchmark.hpp"
#include "app/solver_settings.hpp"
#include "core/solver/clock.hpp"
#include "core/solver/drivers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <climits>

namespace fascia::app {
namespace {

/// Times the steps of an implicit run, warm-up left out.
StepTimes time_steps(const Simulation& s, MechanicalSystem& system, const SolverSettings& settings,
                     const StepPlan& plan) {
  StepTimes times;
  times.cg_iterations = INT_MAX;
  State state = s.initial;
  Clock::time_point start = Clock::now();
  const auto observe = [&](const StepInfo& step, const State&, MechanicalSystem&) {
    if (step.step <= plan.warm_up) {
      start = Clock::now();
      return true;
    }
    times.step_ms.push_back(1e3 * step.seconds);
    times.cg_ms.push_back(1e3 * step.newton.cg_seconds);
    times.cg_iterations = std::min(times.cg_iterations, step.newton.linear_iterations);
    if (times.step_ms.size() == 1) times.residual = step.newton.linear_residual;
    times.trouble = step.newton.trouble;
    const int done = static_cast<int>(times.step_ms.size());
    return done < plan.fewest || (done < plan.most && seconds_since(start) < plan.seconds);
  };
  const RunReport report = run_implicit(
      system, state, [&](double t) { return s.factors(t); }, settings,
      {scheme_of(s.scene.solver.kind), s.scene.solver.time_step, plan.warm_up + plan.most}, observe);
  if (times.step_ms.empty()) times.cg_iterations = 0;
  if (report.status != RunStatus::converged && report.status != RunStatus::interrupted) times.trouble = report.message;
  return times;
}

StepTimes run_on_cpu(const Simulation& s, const StepPlan& plan, int threads) {
  const SolverSettings settings = settings_of(s.scene.solver);
  ThreadPool pool(threads);
  MechanicalSystem system(s.model, pool, settings);
  return time_steps(s, system, settings, plan);
}

Backend cpu(int threads) {
  return {"cpu", threads,
          [threads](const Simulation& s, const StepPlan& plan) { return run_on_cpu(s, plan, threads); }};
}

}  // namespace

std::string Backend::label() const {
  return threads == 0 ? name : fmt::format("{}, {} thread{}", name, threads, threads == 1 ? "" : "s");
}

std::vector<Backend> available_backends(int threads) {
  const int all = threads > 0 ? threads : ThreadPool(0).size();
  std::vector<Backend> backends{cpu(1)};
  if (all > 1) backends.push_back(cpu(all));
  return backends;
}

}  // namespace fascia::app
