#include "gpu/cuda_functions.hpp"

/// What is looked up in fascia-cuda.so: kModuleEntry.
extern "C" const fascia::gpu::DeviceFunctions* fascia_device_functions() { return &fascia::gpu::cuda_functions(); }
