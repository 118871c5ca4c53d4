#include "core/space/space.hpp"
#include "gpu/explicit/explicit_body.hpp"

namespace fascia::gpu {

template class ExplicitSystem<HostSpace>;

}  // namespace fascia::gpu
