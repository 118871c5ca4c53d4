#include "core/space/space.hpp"
#include "gpu/system/levels_body.hpp"

namespace fascia::gpu {

template class Levels<HostSpace>;

}  // namespace fascia::gpu
