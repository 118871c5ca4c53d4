#include "gpu/run/cuda_functions.hpp"

/// The library looks this up in fascia-cuda.so, by the name kModuleEntry.
extern "C" const fascia::gpu::DeviceFunctions* fascia_device_functions() { return &fascia::gpu::cuda_functions(); }
