#include "gpu/dependents_body.hpp"
#include "gpu/space.hpp"

namespace fascia::gpu {

template class Dependents<HostSpace>;

}  // namespace fascia::gpu
