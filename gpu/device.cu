#include "gpu/device.hpp"

#include "gpu/cuda_space.cuh"

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

bool built_with_cuda() { return true; }

std::vector<DeviceInfo> usable_devices(std::string& reason) {
  std::vector<DeviceInfo> devices;
  int driver = 0, runtime = 0, count = 0;
  cudaDriverGetVersion(&driver);
  cudaRuntimeGetVersion(&runtime);
  if (driver == 0) {
    reason = "no NVIDIA driver is installed";
    return devices;
  }
  const cudaError_t status = cudaGetDeviceCount(&count);
  cudaGetLastError();
  if (status == cudaErrorInsufficientDriver) {
    reason =
        "the driver serves CUDA " + version(driver) + ", this build needs " + version(runtime) + ": update the driver";
    return devices;
  }
  if (status != cudaSuccess || count == 0) {
    reason = std::string("no device was found (") + cudaGetErrorString(status) + ")";
    return devices;
  }
  int first = -1;
  for (int i = 0; i < count; ++i) {
    cudaDeviceProp p{};
    if (cudaGetDeviceProperties(&p, i) != cudaSuccess) continue;
    DeviceInfo d{p.name, p.major, p.minor, p.multiProcessorCount, p.totalGlobalMem, 0, driver, runtime};
    if (10 * p.major + p.minor < kOldest) {
      reason = d.name + " has compute capability " + std::to_string(p.major) + "." + std::to_string(p.minor) +
               ", at least 8.0 is needed";
      continue;
    }
    std::size_t total = 0;
    cudaSetDevice(i);
    if (cudaMemGetInfo(&d.free_memory, &total) != cudaSuccess || !runs()) {
      reason = d.name + " does not run this build's code";
      continue;
    }
    devices.push_back(d);
    if (first < 0) first = i;
  }
  cudaSetDevice(first < 0 ? 0 : first);
  return devices;
}

DeviceInfo require_device() {
  std::string reason;
  const std::vector<DeviceInfo> devices = usable_devices(reason);
  if (devices.empty()) throw NoDevice(reason + "; use --backend cpu");
  return devices.front();
}

}  // namespace fascia::gpu
