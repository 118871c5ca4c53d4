#include "core/space/space.hpp"
#include "gpu/elements/elements_body.hpp"

namespace fascia::gpu {

template class Elements<HostSpace>;
template void Elements<HostSpace>::product(const DirectionOf<double, double>&);
template void Elements<HostSpace>::product(const DirectionOf<float, double>&);
template void Elements<HostSpace>::product(const DirectionOf<float, float>&);

}  // namespace fascia::gpu
