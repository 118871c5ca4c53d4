#include "fascia/run/gpu_run.hpp"

#include "assembly/simulation/solver_settings.hpp"
#include "core/base/errors.hpp"
#include "fascia/stepper.hpp"
#include "gpu/space/device.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia {

namespace {

/// What was reached before an error.
RunReport broken_off(RunReport seen, const std::string& why) {
  seen.status = RunStatus::not_converged;
  seen.message =
      fmt::format("after step {}: {}; the results end with the last one that was saved; try again, or --backend cpu",
                  seen.steps, why);
  return seen;
}

/// GPUs that share the run. @throws BackendError  fewer than were asked for
std::vector<int> devices_of(const Simulation& s, const BackendWarning& warn) {
  const Solver& solver = s.scene.solver;
  if (solver.gpus == 1) return {};
  std::string reason;
  std::vector<int> devices = gpu::find_devices(solver.gpus, reason);
  const int found = static_cast<int>(devices.size());
  if (found == solver.gpus) return devices;
  if (solver.backend != "auto") throw BackendError(fmt::format("gpus = {}, but {}", solver.gpus, reason));
  warn(fmt::format("gpus = {}, but {}; {} compute{}", solver.gpus, reason, found, found == 1 ? "s" : ""));
  return devices;
}

/// Calls the kind of run that the scene asks for.
RunReport run_kind(const Simulation& s, State& state, const FactorFunction& factors, const SolverSettings& settings,
                   const gpu::DeviceObserver& watch, const std::function<bool(const StepInfo&)>& observed) {
  const Solver& solver = s.scene.solver;
  if (solver.kind == SolverKind::statics)
    return gpu::run_statics(s.model, state, factors, settings, {solver.load_steps}, watch);
  if (solver.kind == SolverKind::central_differences)
    return gpu::run_explicit(s.model, state, factors, settings, explicit_of(s.scene, observed), watch);
  return gpu::run_implicit(s.model, state, factors, settings, dynamics_of(solver), watch);
}

}  // namespace

std::optional<GpuRun> run_on_gpu(const Simulation& s, State& state, const FactorFunction& factors,
                                 const SolverSettings& asked, const BackendWarning& warn,
                                 const gpu::DeviceObserver& observe,
                                 const std::function<bool(const StepInfo&)>& observed) {
  const Solver& solver = s.scene.solver;
  const bool may_choose = solver.backend == "auto";
  SolverSettings settings = asked;
  settings.devices = devices_of(s, warn);
  RunReport seen;
  bool observing = false;  // an error is the observer's
  const gpu::DeviceObserver watch = [&](const StepInfo& step, ReachedStep& reached) {
    seen.steps = step.step;
    seen.time = step.time;
    seen.newton_iterations += step.newton.iterations;
    seen.linear_iterations += step.newton.linear_iterations;
    seen.residual = std::max(seen.residual, step.newton.last.relative);
    observing = true;
    const bool goes_on = observe(step, reached);
    observing = false;
    return goes_on;
  };
  const auto gpus = [&] { return std::max(1, static_cast<int>(settings.devices.size())); };
  const auto run = [&] { return GpuRun{run_kind(s, state, factors, settings, watch, observed), gpus()}; };
  try {
    try {
      return run();
    } catch (const gpu::NotShared& e) {
      if (!may_choose) throw BackendError(fmt::format("{}; use gpus = 1", e.what()));
      warn(fmt::format("{}; one computes", e.what()));
      settings.devices.clear();
      return run();
    }
  } catch (const gpu::DeviceLost& e) {
    return GpuRun{broken_off(seen, e.what()), gpus()};
  } catch (const gpu::DeviceMemoryError& e) {
    if (seen.steps > 0) return GpuRun{broken_off(seen, e.what()), gpus()};
    if (!may_choose) throw BackendError(e.what());
    warn(fmt::format("{}; the processor goes on{}", e.what(),
                     solver.precision == "double" ? "" : ", in double precision"));
    return std::nullopt;
  } catch (const InputError& e) {  // more of something than the GPU's code can number
    if (observing || seen.steps > 0 || !may_choose) throw;
    warn(fmt::format("{}; the processor goes on", e.what()));
    return std::nullopt;
  } catch (const gpu::NoDevice& e) {
    throw BackendError(e.what());
  }
}

}  // namespace fascia
