#include "core/space/space.hpp"
#include "gpu/blocks/dependents_body.hpp"

namespace fascia::gpu {

template class Dependents<HostSpace>;

}  // namespace fascia::gpu
