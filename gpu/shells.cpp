#include "gpu/shells_body.hpp"
#include "gpu/space.hpp"

namespace fascia::gpu {

template class Shells<HostSpace>;

}  // namespace fascia::gpu
