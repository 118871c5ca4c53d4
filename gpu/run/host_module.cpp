#include "gpu/interface_tag.hpp"
#include "gpu/run/device_functions.hpp"

#include <string>
#include <vector>

namespace fascia::gpu {
namespace {

/// The processor, as the one device that there is.
std::vector<int> find_host(int wanted, std::string& reason) {
  if (wanted > 1) reason = "the space of the host is one device";
  return {0};
}

const DeviceFunctions kHostFunctions{FASCIA_INTERFACE_TAG,
                                     "no device: the GPU's steps in the space of the host",
                                     find_host,
                                     run_statics_on_host,
                                     run_implicit_on_host,
                                     run_explicit_on_host,
                                     make_stepper_on_host,
                                     evaluate_on_host};

}  // namespace
}  // namespace fascia::gpu

/// Computes in the space of the host what fascia-cuda.so computes on a device: slow, and for checks of the GPU's
/// arithmetic where there is no GPU.
extern "C" const fascia::gpu::DeviceFunctions* fascia_device_functions() { return &fascia::gpu::kHostFunctions; }
