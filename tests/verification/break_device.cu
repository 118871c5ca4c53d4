#include "tests/verification/break_device.hpp"

#include <cuda_runtime_api.h>

namespace fascia::test {

namespace {

__global__ void stop() { __trap(); }

}  // namespace

void break_device() {
  stop<<<1, 1>>>();
  cudaDeviceSynchronize();
  cudaGetLastError();
}

std::vector<void*> take_memory() {
  std::vector<void*> taken;
  for (std::size_t bytes = std::size_t{1} << 36; bytes >= std::size_t{1} << 20; bytes /= 2) {
    void* memory = nullptr;
    while (cudaMalloc(&memory, bytes) == cudaSuccess) taken.push_back(memory);
  }
  cudaGetLastError();
  return taken;
}

void give_back(const std::vector<void*>& taken) {
  for (void* memory : taken) cudaFree(memory);
}

}  // namespace fascia::test
