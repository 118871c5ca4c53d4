#include "core/space/space.hpp"
#include "gpu/actions/surfaces_body.hpp"

namespace fascia::gpu {

template class Surfaces<HostSpace>;

}  // namespace fascia::gpu
