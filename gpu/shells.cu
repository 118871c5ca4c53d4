#include "gpu/cuda_space.cuh"
#include "gpu/shells_body.hpp"

namespace fascia::gpu {

template class Shells<CudaSpace>;
template void Shells<CudaSpace>::product(const DirectionOf<double, double>&);
template void Shells<CudaSpace>::product(const DirectionOf<float, double>&);
template void Shells<CudaSpace>::product(const DirectionOf<float, float>&);

}  // namespace fascia::gpu
