#include "gpu/blocks/shells_body.hpp"
#include "gpu/space/cuda_space.cuh"

namespace fascia::gpu {

template class Shells<CudaSpace>;
template void Shells<CudaSpace>::product(const DirectionOf<double, double>&);
template void Shells<CudaSpace>::product(const DirectionOf<float, double>&);
template void Shells<CudaSpace>::product(const DirectionOf<float, float>&);

}  // namespace fascia::gpu
