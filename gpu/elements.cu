#include "gpu/cuda_space.cuh"
#include "gpu/elements_body.hpp"

namespace fascia::gpu {

template class Elements<CudaSpace>;

}  // namespace fascia::gpu
