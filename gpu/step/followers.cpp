#include "core/space/space.hpp"
#include "core/step/followers_body.hpp"

namespace fascia {

template class Followers<HostSpace>;

}  // namespace fascia
