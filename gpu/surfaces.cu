#include "gpu/cuda_space.cuh"
#include "gpu/surfaces_body.hpp"

namespace fascia::gpu {

template class Surfaces<CudaSpace>;

}  // namespace fascia::gpu
