#include "gpu/blocks_body.hpp"
#include "gpu/cuda_space.cuh"
#include "gpu/system_body.hpp"
#include "gpu/system_host.hpp"
#include "gpu/system_levels.hpp"
#include "gpu/system_solve.hpp"
#include "gpu/system_step.hpp"

namespace fascia::gpu {

template class Blocks<CudaSpace>;
template BlocksOf<double> Blocks<CudaSpace>::view_of() const;
template class System<CudaSpace>;

}  // namespace fascia::gpu
