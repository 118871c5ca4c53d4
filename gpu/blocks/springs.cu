#include "gpu/blocks/springs_body.hpp"
#include "gpu/space/cuda_space.cuh"

namespace fascia::gpu {

template class Springs<CudaSpace>;

}  // namespace fascia::gpu
