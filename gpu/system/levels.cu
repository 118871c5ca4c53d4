#include "gpu/space/cuda_space.cuh"
#include "gpu/system/levels_body.hpp"

namespace fascia::gpu {

template class Levels<CudaSpace>;

}  // namespace fascia::gpu
