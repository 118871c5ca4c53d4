#include "gpu/cuda_space.cuh"
#include "gpu/points_body.hpp"

namespace fascia::gpu {

template class Points<CudaSpace>;

}  // namespace fascia::gpu
