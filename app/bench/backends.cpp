#include "app/bench/benchmark.hpp"
#include "app/run/run_scene.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "core/base/clock.hpp"
#include "core/base/errors.hpp"
#include "core/run/drivers.hpp"
#include "core/solver/mechanical_system.hpp"
#include "fascia/stepper.hpp"
#include "gpu/run/run.hpp"
#include "gpu/space/device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <climits>

namespace fascia::app {
namespace {

/// Collects the times of the steps of an implicit run, warm-up left out.
class StepWatch {
 public:
  explicit StepWatch(const StepPlan& plan) : plan_(plan) { times_.cg_iterations = INT_MAX; }

  /// Goes on?
  bool see(const StepInfo& step) {
    if (step.step <= plan_.warm_up) {
      start_ = Clock::now();
      return true;
    }
    times_.step_ms.push_back(1e3 * step.seconds);
    times_.cg_ms.push_back(1e3 * step.newton.cg_seconds);
    times_.cg_iterations = std::min(times_.cg_iterations, step.newton.linear_iterations);
    if (times_.step_ms.size() == 1) times_.residual = step.newton.linear_residual;
    times_.trouble = step.newton.trouble;
    const int done = static_cast<int>(times_.step_ms.size());
    return done < plan_.fewest || (done < plan_.most && seconds_since(start_) < plan_.seconds);
  }
  StepTimes times(const RunReport& report) && {
    if (times_.step_ms.empty()) times_.cg_iterations = 0;
    if (report.status != RunStatus::converged && report.status != RunStatus::interrupted)
      times_.trouble = report.message;
    return std::move(times_);
  }

 private:
  const StepPlan& plan_;
  StepTimes times_;
  Clock::time_point start_ = Clock::now();
};

DynamicsSettings dynamics_of(const Simulation& s, const StepPlan& plan) {
  return {scheme_of(s.scene.solver.kind), s.scene.solver.time_step, plan.warm_up + plan.most};
}

StepTimes run_on_cpu(const Simulation& s, const StepPlan& plan, int threads) {
  const SolverSettings settings = settings_of(s.scene.solver);
  ThreadPool pool(threads);
  MechanicalSystem system(s.model, pool, settings);
  State state = s.initial;
  StepWatch watch(plan);
  const RunReport report = run_implicit(
      system, state, [&](double t) { return s.factors(t); }, settings, dynamics_of(s, plan),
      [&](const StepInfo& step, const State&, MechanicalSystem&) { return watch.see(step); });
  return std::move(watch).times(report);
}

StepTimes run_on_gpu(const Simulation& s, const StepPlan& plan, const std::vector<int>& devices) {
  State state = s.initial;
  SolverSettings settings = settings_of(s.scene.solver);
  settings.devices = devices;
  StepWatch watch(plan);
  const RunReport report = gpu::run_implicit(
      s.model, state, [&](double t) { return s.factors(t); }, settings, dynamics_of(s, plan),
      [&](const StepInfo& step, ReachedStep&) { return watch.see(step); });
  return std::move(watch).times(report);
}

}  // namespace

BenchBackend processor(int threads) {
  return {"cpu", threads,
          [threads](const Simulation& s, const StepPlan& plan) { return run_on_cpu(s, plan, threads); }};
}

std::string BenchBackend::label() const {
  if (gpus > 1) return fmt::format("{}, {} GPUs", name, gpus);
  return threads == 0 ? name : fmt::format("{}, {} thread{}", name, threads, threads == 1 ? "" : "s");
}

std::vector<BenchBackend> available_backends(int threads, const std::vector<int>& gpus) {
  const int all = threads > 0 ? threads : ThreadPool(0).size();
  std::vector<BenchBackend> backends{processor(1)};
  if (all > 1) backends.push_back(processor(all));
  std::string reason;
  const bool has_gpu = gpu::find_device(reason);
  for (const int count : gpus) {
    if (count == 1 && !has_gpu) continue;
    const std::vector<int> devices = gpu::find_devices(count, reason);
    if (static_cast<int>(devices.size()) < count)
      throw BackendError(fmt::format("--gpus {}, but {}; leave out --gpus", count, reason));
    const std::vector<int> shared = count == 1 ? std::vector<int>{} : devices;
    backends.push_back({"cuda", 0,
                        [shared](const Simulation& s, const StepPlan& plan) { return run_on_gpu(s, plan, shared); },
                        count});
  }
  return backends;
}

std::vector<BenchBackend> chosen_backends(const BenchOptions& options) {
  const bool many = std::any_of(options.gpus.begin(), options.gpus.end(), [](int count) { return count > 1; });
  if (options.backend == "cpu" && many)
    throw InputError("--gpus does not go with --backend cpu; leave out one of them");
  std::string reason;
  if (options.backend == "cuda" && !gpu::find_device(reason))
    throw BackendError(fmt::format("{}; leave out --backend", reason));
  std::vector<BenchBackend> backends = available_backends(options.threads, options.gpus);
  std::erase_if(backends, [&](const BenchBackend& b) { return options.backend && b.name != *options.backend; });
  return backends;
}

}  // namespace fascia::app
