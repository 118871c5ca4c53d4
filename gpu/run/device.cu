#include "gpu/run/cuda_functions.hpp"
#include "gpu/space/cuda_space.cuh"

#include <string>

namespace fascia::gpu {

namespace {

constexpr int kOldest = 80;  ///< compute capability

std::string version(int v) { return std::to_string(v / 1000) + "." + std::to_string(v % 1000 / 10); }

__global__ void set_one(int* value) { *value = 1; }

/// This build's code runs on the present device.
bool runs() {
  int* value = nullptr;
  if (cudaMalloc(&value, sizeof(int)) != cudaSuccess) return false;
  set_one<<<1, 1>>>(value);
  int got = 0;
  const bool good = cudaGetLastError() == cudaSuccess &&
                    cudaMemcpy(&got, value, sizeof(int), cudaMemcpyDeviceToHost) == cudaSuccess && got == 1;
  cudaFree(value);
  cudaGetLastError();
  return good;
}

}  // namespace

std::vector<int> find_cuda_devices(int wanted, std::string& reason) {
  std::vector<int> found;
  int driver = 0, runtime = 0, count = 0;
  cudaDriverGetVersion(&driver);
  cudaRuntimeGetVersion(&runtime);
  if (driver == 0) {
    reason = "no NVIDIA driver is installed";
    return found;
  }
  const cudaError_t status = cudaGetDeviceCount(&count);
  cudaGetLastError();
  if (status == cudaErrorInsufficientDriver) {
    reason =
        "the driver serves CUDA " + version(driver) + ", this build needs " + version(runtime) + ": update the driver";
    return found;
  }
  if (status != cudaSuccess || count == 0) {
    reason = std::string("no device was found (") + cudaGetErrorString(status) + ")";
    return found;
  }
  for (int i = 0; i < count && static_cast<int>(found.size()) < wanted; ++i) {
    cudaDeviceProp p{};
    if (cudaGetDeviceProperties(&p, i) != cudaSuccess) continue;
    if (10 * p.major + p.minor < kOldest) {
      reason = std::string(p.name) + " has compute capability " + std::to_string(p.major) + "." +
               std::to_string(p.minor) + ", at least 8.0 is needed";
      continue;
    }
    cudaSetDevice(i);
    if (runs())
      found.push_back(i);
    else
      reason = std::string(p.name) + " does not run this build's code";
  }
  if (!found.empty()) cudaSetDevice(found.front());
  if (reason.empty() && static_cast<int>(found.size()) < wanted)
    reason = "this machine has " + std::to_string(count) + (count == 1 ? " GPU" : " GPUs");
  return found;
}

}  // namespace fascia::gpu
