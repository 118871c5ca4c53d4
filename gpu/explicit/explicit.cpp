#include "core/space/space.hpp"
#include "gpu/explicit/explicit_body.hpp"

namespace fascia::gpu {

template class ExplicitSystem<HostSpace>;

}  // namespace fascia::gpu

namespace fascia {

template class ExplicitSteps<gpu::ExplicitSystem<HostSpace>, gpu::DeviceStep<HostSpace>>;

}  // namespace fascia
