#include "gpu/cuda_space.cuh"
#include "gpu/followers_body.hpp"

namespace fascia::gpu {

template class Followers<CudaSpace>;

}  // namespace fascia::gpu
