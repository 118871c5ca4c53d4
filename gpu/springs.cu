#include "gpu/cuda_space.cuh"
#include "gpu/springs_body.hpp"

namespace fascia::gpu {

template class Springs<CudaSpace>;

}  // namespace fascia::gpu
