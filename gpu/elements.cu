#include "gpu/cuda_space.cuh"
#include "gpu/elements_body.hpp"

namespace fascia::gpu {

template class Elements<CudaSpace>;
template void Elements<CudaSpace>::product(const DirectionOf<double, double>&);
template void Elements<CudaSpace>::product(const DirectionOf<float, double>&);
template void Elements<CudaSpace>::product(const DirectionOf<float, float>&);

}  // namespace fascia::gpu
