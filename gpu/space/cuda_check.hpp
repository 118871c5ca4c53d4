#pragma once

#include <cuda_runtime_api.h>

namespace fascia::gpu {

/// @throws NoDevice, DeviceMemoryError, DeviceLost  by the kind of error (device.hpp). @param doing  what was being
/// done
void check(cudaError_t status, const char* doing);

}  // namespace fascia::gpu
