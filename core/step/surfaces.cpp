#include "core/space/pool_space.hpp"
#include "core/step/surfaces_body.hpp"

namespace fascia {

template class Surfaces<PoolSpace>;

}  // namespace fascia
