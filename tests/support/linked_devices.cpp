#include "gpu/run/cuda_functions.hpp"

/// In test programs that have CUDA's part linked in: no module is looked for.
namespace {

[[maybe_unused]] const bool linked = [] {
  fascia::gpu::use_device_functions(fascia::gpu::cuda_functions());
  return true;
}();

}  // namespace
