#include "gpu/explicit_body.hpp"
#include "gpu/space.hpp"

namespace fascia::gpu {

template class ExplicitSystem<HostSpace>;

}  // namespace fascia::gpu
