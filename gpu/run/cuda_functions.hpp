#pragma once

#include "gpu/run/device_functions.hpp"

namespace fascia::gpu {

/// CUDA's, for the module and for programs that link this part.
const DeviceFunctions& cuda_functions();

/// find_devices() of CUDA.
std::vector<int> find_cuda_devices(int wanted, std::string& reason);

}  // namespace fascia::gpu
