#include "gpu/actions/followers_body.hpp"
#include "gpu/space/cuda_space.cuh"

namespace fascia::gpu {

template class Followers<CudaSpace>;

}  // namespace fascia::gpu
