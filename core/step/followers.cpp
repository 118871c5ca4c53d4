#include "core/space/pool_space.hpp"
#include "core/step/followers_body.hpp"

namespace fascia {

template class Followers<PoolSpace>;

}  // namespace fascia
