#include "core/space/space.hpp"
#include "gpu/blocks/blocks_body.hpp"
#include "gpu/system/system_body.hpp"
#include "gpu/system/system_host.hpp"
#include "gpu/system/system_levels.hpp"
#include "gpu/system/system_solve.hpp"
#include "gpu/system/system_step.hpp"

namespace fascia::gpu {

template class Blocks<HostSpace>;
template BlocksOf<double> Blocks<HostSpace>::view_of() const;
template class System<HostSpace>;

}  // namespace fascia::gpu

namespace fascia {

template class StepSystem<gpu::System<HostSpace>, gpu::DeviceStep<HostSpace>>;

}  // namespace fascia
