#include "gpu/blocks/blocks_body.hpp"
#include "gpu/space/cuda_space.cuh"
#include "gpu/system/system_body.hpp"
#include "gpu/system/system_host.hpp"
#include "gpu/system/system_levels.hpp"
#include "gpu/system/system_solve.hpp"
#include "gpu/system/system_step.hpp"

namespace fascia::gpu {

template class Blocks<CudaSpace>;
template BlocksOf<double> Blocks<CudaSpace>::view_of() const;
template class System<CudaSpace>;

}  // namespace fascia::gpu

namespace fascia {

template class StepSystem<gpu::System<gpu::CudaSpace>, gpu::DeviceStep<gpu::CudaSpace>>;

}  // namespace fascia
