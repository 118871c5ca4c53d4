#include "gpu/cuda_space.cuh"
#include "gpu/levels_body.hpp"

namespace fascia::gpu {

template class Levels<CudaSpace>;

}  // namespace fascia::gpu
