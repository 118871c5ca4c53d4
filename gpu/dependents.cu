#include "gpu/cuda_space.cuh"
#include "gpu/dependents_body.hpp"

namespace fascia::gpu {

template class Dependents<CudaSpace>;

}  // namespace fascia::gpu
