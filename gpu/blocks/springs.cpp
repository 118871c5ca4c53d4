#include "core/space/space.hpp"
#include "gpu/blocks/springs_body.hpp"

namespace fascia::gpu {

template class Springs<HostSpace>;

}  // namespace fascia::gpu
