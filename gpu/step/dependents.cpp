#include "core/space/space.hpp"
#include "core/step/dependents_body.hpp"

namespace fascia {

template class Dependents<HostSpace>;

}  // namespace fascia
