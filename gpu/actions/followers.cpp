#include "gpu/actions/followers_body.hpp"
#include "core/space/space.hpp"

namespace fascia::gpu {

template class Followers<HostSpace>;

}  // namespace fascia::gpu
