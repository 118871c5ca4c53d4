#include "gpu/actions/surfaces_body.hpp"
#include "gpu/space/space.hpp"

namespace fascia::gpu {

template class Surfaces<HostSpace>;

}  // namespace fascia::gpu
