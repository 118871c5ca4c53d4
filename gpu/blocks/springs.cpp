#include "gpu/blocks/springs_body.hpp"
#include "gpu/space/space.hpp"

namespace fascia::gpu {

template class Springs<HostSpace>;

}  // namespace fascia::gpu
