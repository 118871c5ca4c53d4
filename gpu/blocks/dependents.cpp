#include "gpu/blocks/dependents_body.hpp"
#include "core/space/space.hpp"

namespace fascia::gpu {

template class Dependents<HostSpace>;

}  // namespace fascia::gpu
