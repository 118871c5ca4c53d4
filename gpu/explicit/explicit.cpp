#include "gpu/explicit/explicit_body.hpp"
#include "core/space/space.hpp"

namespace fascia::gpu {

template class ExplicitSystem<HostSpace>;

}  // namespace fascia::gpu
