#include "core/space/space.hpp"
#include "core/step/surfaces_body.hpp"

namespace fascia {

template class Surfaces<HostSpace>;

}  // namespace fascia
