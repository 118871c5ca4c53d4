#include "gpu/blocks/springs_body.hpp"
#include "core/space/space.hpp"

namespace fascia::gpu {

template class Springs<HostSpace>;

}  // namespace fascia::gpu
