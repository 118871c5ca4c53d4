#include "gpu/followers_body.hpp"
#include "gpu/space.hpp"

namespace fascia::gpu {

template class Followers<HostSpace>;

}  // namespace fascia::gpu
