#include "gpu/space/device.hpp"
#include "gpu/tiles/tile_team_solver.cuh"

#include <cstdlib>
#include <set>
#include <string>
#include <string_view>

namespace fascia::tile {

namespace {

/// Memory that `device` takes as it runs, for `other`.
void share_pool(int device, int other) {
  cudaMemPool_t pool = nullptr;
  check(cudaDeviceGetDefaultMemPool(&pool, device), "looking at a GPU's memory");
  cudaMemAccessDesc access{};
  access.location = {cudaMemLocationTypeDevice, other};
  access.flags = cudaMemAccessFlagsProtReadWrite;
  check(cudaMemPoolSetAccess(pool, &access, 1), "sharing a GPU's memory");
}

}  // namespace

void connect_devices(std::span<const int> devices) {
  const std::set<int> all(devices.begin(), devices.end());
  const char* blocking = std::getenv("CUDA_LAUNCH_BLOCKING");
  if (all.size() > 1 && blocking != nullptr && std::string_view(blocking) != "0")
    throw gpu::NotShared("GPUs that share a run wait for one another, which CUDA_LAUNCH_BLOCKING does not allow");
  for (const int device : all) {
    const OnDevice on(device);
    for (const int other : all) {
      if (device == other) continue;
      int possible = 0;
      check(cudaDeviceCanAccessPeer(&possible, device, other), "looking at a GPU's neighbours");
      if (possible == 0)
        throw gpu::NotShared("GPU " + std::to_string(device) + " cannot read the memory of GPU " +
                             std::to_string(other));
      const cudaError_t status = cudaDeviceEnablePeerAccess(other, 0);
      if (status == cudaErrorPeerAccessAlreadyEnabled)
        cudaGetLastError();
      else
        check(status, "connecting GPUs");
      share_pool(other, device);
    }
  }
}

TeamStream::TeamStream(int device) : device_(device) {
  const OnDevice on(device_);
  check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "making a stream");
  check(cudaEventCreateWithFlags(&event_, cudaEventDisableTiming), "making an event");
}

TeamStream::~TeamStream() {
  cudaEventDestroy(event_);
  cudaStreamDestroy(stream_);
}

}  // namespace fascia::tile
