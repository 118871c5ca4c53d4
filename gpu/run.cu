#include "gpu/cuda_functions.hpp"
#include "gpu/cuda_space.cuh"
#include "gpu/explicit_run.hpp"
#include "gpu/interface_tag.hpp"
#include "gpu/run_body.hpp"

namespace fascia::gpu {

const DeviceFunctions& cuda_functions() {
  static const DeviceFunctions functions{FASCIA_INTERFACE_TAG,       FASCIA_CUDA,
                                         find_cuda_devices,          run_statics_in<CudaSpace>,
                                         run_implicit_in<CudaSpace>, run_explicit_in<CudaSpace>,
                                         evaluate_in<CudaSpace>};
  return functions;
}

}  // namespace fascia::gpu
