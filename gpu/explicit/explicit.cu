#include "gpu/explicit/explicit_body.hpp"
#include "gpu/space/cuda_space.cuh"

namespace fascia::gpu {

template class ExplicitSystem<CudaSpace>;

}  // namespace fascia::gpu

namespace fascia {

template class ExplicitSteps<gpu::ExplicitSystem<gpu::CudaSpace>, gpu::DeviceStep<gpu::CudaSpace>>;

}  // namespace fascia
