#include "core/step/followers_body.hpp"
#include "gpu/space/cuda_space.cuh"

namespace fascia {

template class Followers<gpu::CudaSpace>;

}  // namespace fascia
