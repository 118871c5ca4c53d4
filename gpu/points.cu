#include "gpu/cuda_space.cuh"
#include "gpu/points_body.hpp"

namespace fascia::gpu {

template class Points<CudaSpace>;
template void Points<CudaSpace>::product(const DirectionOf<double, double>&);
template void Points<CudaSpace>::product(const DirectionOf<float, double>&);
template void Points<CudaSpace>::product(const DirectionOf<float, float>&);

}  // namespace fascia::gpu
