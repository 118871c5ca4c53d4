#include "core/space/space.hpp"
#include "gpu/actions/followers_body.hpp"

namespace fascia::gpu {

template class Followers<HostSpace>;

}  // namespace fascia::gpu
