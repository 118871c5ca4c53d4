#include "gpu/actions/surfaces_body.hpp"
#include "core/space/space.hpp"

namespace fascia::gpu {

template class Surfaces<HostSpace>;

}  // namespace fascia::gpu
