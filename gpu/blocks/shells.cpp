#include "core/space/space.hpp"
#include "gpu/blocks/shells_body.hpp"

namespace fascia::gpu {

template class Shells<HostSpace>;
template void Shells<HostSpace>::product(const DirectionOf<double, double>&);
template void Shells<HostSpace>::product(const DirectionOf<float, double>&);
template void Shells<HostSpace>::product(const DirectionOf<float, float>&);

}  // namespace fascia::gpu
