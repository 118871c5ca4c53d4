#include "gpu/elements/elements_body.hpp"
#include "gpu/space/cuda_space.cuh"

namespace fascia::gpu {

template class Elements<CudaSpace>;
template void Elements<CudaSpace>::product(const DirectionOf<double, double>&);
template void Elements<CudaSpace>::product(const DirectionOf<float, double>&);
template void Elements<CudaSpace>::product(const DirectionOf<float, float>&);

}  // namespace fascia::gpu
