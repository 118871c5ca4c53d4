#include "gpu/elements_body.hpp"
#include "gpu/space.hpp"

namespace fascia::gpu {

template class Elements<HostSpace>;

}  // namespace fascia::gpu
