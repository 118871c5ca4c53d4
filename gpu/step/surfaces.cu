#include "core/step/surfaces_body.hpp"
#include "gpu/space/cuda_space.cuh"

namespace fascia {

template class Surfaces<gpu::CudaSpace>;

}  // namespace fascia
