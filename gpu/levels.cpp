#include "gpu/levels_body.hpp"
#include "gpu/space.hpp"

namespace fascia::gpu {

template class Levels<HostSpace>;

}  // namespace fascia::gpu
