#include "gpu/blocks/dependents_body.hpp"
#include "gpu/space/cuda_space.cuh"

namespace fascia::gpu {

template class Dependents<CudaSpace>;

}  // namespace fascia::gpu
