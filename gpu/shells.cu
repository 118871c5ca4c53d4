#include "gpu/cuda_space.cuh"
#include "gpu/shells_body.hpp"

namespace fascia::gpu {

template class Shells<CudaSpace>;

}  // namespace fascia::gpu
