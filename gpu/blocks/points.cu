#include "gpu/blocks/points_body.hpp"
#include "gpu/space/cuda_space.cuh"

namespace fascia::gpu {

template class Points<CudaSpace>;
template void Points<CudaSpace>::product(const DirectionOf<double, double>&);
template void Points<CudaSpace>::product(const DirectionOf<float, double>&);
template void Points<CudaSpace>::product(const DirectionOf<float, float>&);

}  // namespace fascia::gpu
