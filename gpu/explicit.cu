#include "gpu/cuda_space.cuh"
#include "gpu/explicit_body.hpp"

namespace fascia::gpu {

template class ExplicitSystem<CudaSpace>;

}  // namespace fascia::gpu
