#include "gpu/blocks/dependents_body.hpp"
#include "gpu/space/space.hpp"

namespace fascia::gpu {

template class Dependents<HostSpace>;

}  // namespace fascia::gpu
