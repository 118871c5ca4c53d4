#include "gpu/explicit/explicit_body.hpp"
#include "gpu/space/cuda_space.cuh"

namespace fascia::gpu {

template class ExplicitSystem<CudaSpace>;

}  // namespace fascia::gpu
