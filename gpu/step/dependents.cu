#include "core/step/dependents_body.hpp"
#include "gpu/space/cuda_space.cuh"

namespace fascia {

template class Dependents<gpu::CudaSpace>;

}  // namespace fascia
