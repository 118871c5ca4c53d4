#include "gpu/device.hpp"
#include "gpu/tile_team_solver.cuh"

#include <set>
#include <string>

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
  for (const int device : all) {
    const OnDevice on(device);
    for (const int other : all) {
      if (device == other) continue;
      int possible = 0;
      check(cudaDeviceCanAccessPeer(&possible, device, other), "looking at a GPU's neighbours");
      if (possible == 0)
        throw gpu::NoDevice("GPU " + std::to_string(device) + " cannot read the memory of GPU " +
                            std::to_string(other) + "; use one GPU");
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
