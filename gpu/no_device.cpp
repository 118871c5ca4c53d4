#include "gpu/device.hpp"

/// A build without the CUDA toolkit.
namespace fascia::gpu {

bool built_with_cuda() { return false; }

std::vector<DeviceInfo> usable_devices(std::string& reason) {
  reason = "this build has no CUDA backend";
  return {};
}

DeviceInfo require_device() {
  throw NoDevice("backend \"cuda\" is not in this build, which was made without the CUDA toolkit; use --backend cpu");
}

}  // namespace fascia::gpu
