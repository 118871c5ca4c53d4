#include "app/gpu_run.hpp"

#include "app/run_scene.hpp"
#include "app/solver_settings.hpp"
#include "core/model/errors.hpp"
#include "gpu/device.hpp"

#include <fmt/format.h>

namespace fascia::app {

namespace {

/// What was reached before an error.
RunReport broken_off(RunReport seen, const std::string& why) {
  seen.status = RunStatus::not_converged;
  seen.message =
      fmt::format("after step {}: {}; the results end with the last one that was saved; try again, or --backend cpu",
                  seen.steps, why);
  return seen;
}

}  // namespace

std::optional<RunReport> run_on_gpu(const Simulation& s, State& state, const FactorFunction& factors,
                                    const SolverSettings& settings, const gpu::DeviceObserver& observe,
                                    const std::function<bool(const StepInfo&)>& observed) {
  const Solver& solver = s.scene.solver;
  RunReport seen;
  const gpu::DeviceObserver watch = [&](const StepInfo& step, gpu::DeviceStep& device) {
    seen.steps = step.step;
    seen.time = step.time;
    seen.newton_iterations += step.newton.iterations;
    seen.linear_iterations += step.newton.linear_iterations;
    seen.residual = std::max(seen.residual, step.newton.last.relative);
    return observe(step, device);
  };
  try {
    if (solver.kind == SolverKind::statics)
      return gpu::run_statics(s.model, state, factors, settings, {solver.load_steps}, watch);
    if (solver.kind == SolverKind::central_differences)
      return gpu::run_explicit(s.model, state, factors, settings, {solver.time_step, solver.steps, observed}, watch);
    return gpu::run_implicit(s.model, state, factors, settings,
                             {scheme_of(solver.kind), solver.time_step, solver.steps}, watch);
  } catch (const gpu::DeviceLost& e) {
    return broken_off(seen, e.what());
  } catch (const gpu::DeviceMemoryError& e) {
    if (seen.steps > 0) return broken_off(seen, e.what());
    if (solver.backend != "auto") throw BackendError(e.what());
    fmt::print(stderr, "{}: warning: {}; the processor goes on{}\n", s.scene.path.string(), e.what(),
               solver.precision == "double" ? "" : ", in double precision");
    return std::nullopt;
  } catch (const InputError& e) {  // more of something than the GPU's code can number
    if (seen.steps > 0 || solver.backend != "auto") throw;
    fmt::print(stderr, "{}: warning: {}; the processor goes on\n", s.scene.path.string(), e.what());
    return std::nullopt;
  } catch (const gpu::NoDevice& e) {
    throw BackendError(e.what());
  }
}

}  // namespace fascia::app
