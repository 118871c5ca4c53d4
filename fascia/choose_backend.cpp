#include "fascia/choose_backend.hpp"

#include "gpu/space/device.hpp"

#include <fmt/format.h>

namespace fascia {

namespace {

/// Unknowns below which the processor solves directly, which slender bodies want, and a run is over before the GPU has
/// started (docs/performance.md).
constexpr int kWorthwhile = 15000;

}  // namespace

std::string not_on_gpu(const Simulation& s) {
  const Solver& solver = s.scene.solver;
  if (solver.kind == SolverKind::modes) return "solver.kind = \"modes\"";
  if (solver.control == StaticControl::arc_length) return "solver.control = \"arc-length\"";
  if (solver.control == StaticControl::displacement) return "solver.control = \"displacement\"";
  if (solver.linear == LinearMethod::cholesky) return "solver.linear.kind = \"cholesky\"";
  if (solver.preconditioner == PreconditionerKind::cholesky) return "solver.linear.preconditioner = \"cholesky\"";
  if (solver.preconditioner == PreconditionerKind::multigrid && solver.precision == "single")
    return "solver.linear.preconditioner = \"multigrid\" with precision = \"single\"";
  return "";
}

Backend choose_backend(const Simulation& s) {
  const std::string& asked = s.scene.solver.backend;
  const bool single = s.scene.solver.precision == "single";
  const int gpus = s.scene.solver.gpus;
  if (asked == "cpu") return Backend::cpu;
  const std::string missing = not_on_gpu(s);
  if (asked == "cuda") {
    try {
      gpu::require_device();
    } catch (const gpu::NoDevice& e) {
      throw BackendError(e.what());
    }
    if (!missing.empty())
      throw BackendError(fmt::format("{}the GPU does not compute {}; use --backend cpu, or auto",
                                     s.scene.path.empty() ? "" : s.scene.path.string() + ": ", missing));
    return Backend::cuda;
  }
  if (!missing.empty() || (!single && gpus == 1 && s.model.free_dof_count() < kWorthwhile)) return Backend::cpu;
  std::string reason;
  return gpu::find_device(reason) ? Backend::cuda : Backend::cpu;
}

std::string precision_of(const Simulation& s, Backend backend, bool iterated) {
  const std::string& asked = s.scene.solver.precision;
  return backend == Backend::cuda || (asked == "mixed" && iterated) ? asked : "double";
}

std::string not_as_asked(const Simulation& s, Backend backend) {
  const Solver& solver = s.scene.solver;
  const bool single = solver.precision == "single";
  if (backend == Backend::cuda || (!single && solver.gpus == 1)) return "";
  const std::string missing = not_on_gpu(s);
  const std::string asked = single ? "precision = \"single\"" : fmt::format("gpus = {}", solver.gpus);
  return fmt::format("{} needs the GPU, {}: computed {}on the processor", asked,
                     missing.empty() ? "and there is none" : "which does not compute " + missing,
                     solver.precision == "mixed" ? "" : "in double ");
}

bool is_of_device(const std::exception& e) {
  return dynamic_cast<const gpu::NoDevice*>(&e) != nullptr ||
         dynamic_cast<const gpu::DeviceMemoryError*>(&e) != nullptr ||
         dynamic_cast<const gpu::DeviceLost*>(&e) != nullptr || dynamic_cast<const gpu::NotShared*>(&e) != nullptr;
}

const char* name_of(Backend backend) { return backend == Backend::cuda ? "cuda" : "cpu"; }

}  // namespace fascia
