#include "gpu/space.hpp"
#include "gpu/springs_body.hpp"

namespace fascia::gpu {

template class Springs<HostSpace>;

}  // namespace fascia::gpu
