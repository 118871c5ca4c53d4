#include "gpu/interface_tag.hpp"
#include "gpu/run/cuda_functions.hpp"
#include "gpu/run/explicit_run.hpp"
#include "gpu/run/run_body.hpp"
#include "gpu/space/cuda_space.cuh"

namespace fascia::gpu {

const DeviceFunctions& cuda_functions() {
  static const DeviceFunctions functions{FASCIA_INTERFACE_TAG,       FASCIA_CUDA,
                                         find_cuda_devices,          run_statics_in<CudaSpace>,
                                         run_implicit_in<CudaSpace>, run_explicit_in<CudaSpace>,
                                         make_stepper_in<CudaSpace>, evaluate_in<CudaSpace>};
  return functions;
}

}  // namespace fascia::gpu
