#include "gpu/device.hpp"
#include "gpu/run.hpp"

/// A build without the CUDA toolkit.
namespace fascia::gpu {

std::vector<int> find_devices(int, std::string& reason) {
  reason = "this build has no CUDA backend";
  return {};
}

void require_device() {
  throw NoDevice(
      "backend \"cuda\" is not in this build, which was made without the CUDA toolkit; use --backend auto, "
      "or cpu");
}

RunReport run_statics(const Model&, State&, const FactorFunction&, const SolverSettings&, const StaticsSettings&,
                      const DeviceObserver&) {
  require_device();
  return {};
}

RunReport run_implicit(const Model&, State&, const FactorFunction&, const SolverSettings&, const DynamicsSettings&,
                       const DeviceObserver&) {
  require_device();
  return {};
}

RunReport run_explicit(const Model&, State&, const FactorFunction&, const SolverSettings&, const ExplicitSettings&,
                       const DeviceObserver&) {
  require_device();
  return {};
}

DeviceEvaluation evaluate(const Model&, const State&, std::span<const double>, const SolverSettings&,
                          std::span<const double>) {
  require_device();
  return {};
}

}  // namespace fascia::gpu
