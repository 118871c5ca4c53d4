#include "core/space/space.hpp"
#include "gpu/blocks/points_body.hpp"

namespace fascia::gpu {

template class Points<HostSpace>;
template void Points<HostSpace>::product(const DirectionOf<double, double>&);
template void Points<HostSpace>::product(const DirectionOf<float, double>&);
template void Points<HostSpace>::product(const DirectionOf<float, float>&);

}  // namespace fascia::gpu
