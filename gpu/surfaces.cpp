#include "gpu/space.hpp"
#include "gpu/surfaces_body.hpp"

namespace fascia::gpu {

template class Surfaces<HostSpace>;

}  // namespace fascia::gpu
