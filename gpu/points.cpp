#include "gpu/points_body.hpp"
#include "gpu/space.hpp"

namespace fascia::gpu {

template class Points<HostSpace>;

}  // namespace fascia::gpu
