#include "gpu/actions/surfaces_body.hpp"
#include "gpu/space/cuda_space.cuh"

namespace fascia::gpu {

template class Surfaces<CudaSpace>;

}  // namespace fascia::gpu
