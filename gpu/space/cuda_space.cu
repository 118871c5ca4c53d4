#include "gpu/space/cuda_space.cuh"

#include <string>

namespace fascia::gpu {

void check(cudaError_t status, const char* doing) {
  if (status == cudaSuccess) return;
  const std::string what = std::string("gpu: ") + doing + ": " + cudaGetErrorString(status);
  cudaGetLastError();
  switch (status) {
    case cudaErrorMemoryAllocation:
      throw DeviceMemoryError(what + "; use --backend cpu or a smaller scene");
    case cudaErrorNoDevice:
    case cudaErrorInsufficientDriver:
    case cudaErrorNoKernelImageForDevice:
    case cudaErrorInitializationError:
    case cudaErrorUnsupportedPtxVersion:
      throw NoDevice(what);
    case cudaErrorECCUncorrectable:
    case cudaErrorHardwareStackError:
    case cudaErrorLaunchFailure:
    case cudaErrorLaunchTimeout:
    case cudaErrorIllegalAddress:
    case cudaErrorDevicesUnavailable:
    case cudaErrorNvlinkUncorrectable:
    case cudaErrorUnknown:
      throw DeviceLost(what);
    default:
      throw std::runtime_error(what);
  }
}

/// Memory that is released stays with the process: a step takes and releases some.
cudaStream_t CudaSpace::make_stream() {
  cudaStream_t stream = nullptr;
  check(cudaStreamCreate(&stream), "making a stream");
  int device = 0;
  cudaMemPool_t pool = nullptr;
  std::uint64_t all = ~std::uint64_t{0};
  check(cudaGetDevice(&device), "looking at the device");
  check(cudaDeviceGetDefaultMemPool(&pool, device), "looking at the device's memory");
  check(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &all), "looking at the device's memory");
  return stream;
}

cudaStream_t CudaSpace::stream() {
  struct Stream {
    cudaStream_t handle = make_stream();
    ~Stream() { cudaStreamDestroy(handle); }
  };
  thread_local const Stream stream;
  return stream.handle;
}

const CudaSpace::Scratch& CudaSpace::scratch() {
  struct Owned : Scratch {
    Owned() {
      check(cudaMalloc(&partial, kMostSums * kMostBlocks * sizeof(double)), "taking memory for sums");
      check(cudaMalloc(&finished, sizeof(unsigned)), "taking memory for sums");
      check(cudaMemset(finished, 0, sizeof(unsigned)), "preparing sums");
    }
    ~Owned() {
      cudaFree(partial);
      cudaFree(finished);
    }
  };
  thread_local const Owned owned;
  return owned;
}

void* CudaSpace::allocate(std::size_t bytes) {
  if (bytes == 0) return nullptr;
  void* memory = nullptr;
  const cudaError_t status = cudaMallocAsync(&memory, bytes, stream());
  if (status == cudaErrorMemoryAllocation) {
    cudaGetLastError();
    std::size_t available = 0, total = 0;
    cudaMemGetInfo(&available, &total);
    const auto megabytes = [](std::size_t n) { return std::to_string(n / 1000000) + " MB"; };
    throw DeviceMemoryError("gpu: out of memory: asked for " + megabytes(bytes) + ", " + megabytes(available) +
                            " free of " + megabytes(total) + "; use --backend cpu or a smaller scene");
  }
  check(status, "taking memory");
  return memory;
}

void CudaSpace::release(void* memory) noexcept {
  if (memory != nullptr) cudaFreeAsync(memory, stream());
}

void CudaSpace::copy_in(void* to, const void* from, std::size_t bytes) {
  if (bytes == 0) return;
  check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, stream()), "copying to the device");
  synchronize();
}

void CudaSpace::copy_out(void* to, const void* from, std::size_t bytes) {
  if (bytes == 0) return;
  check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, stream()), "copying from the device");
  synchronize();
}

void CudaSpace::copy(void* to, const void* from, std::size_t bytes) {
  if (bytes > 0) check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice, stream()), "copying on the device");
}

void CudaSpace::set_zero(void* memory, std::size_t bytes) {
  if (bytes > 0) check(cudaMemsetAsync(memory, 0, bytes, stream()), "clearing memory of the device");
}

void CudaSpace::synchronize() { check(cudaStreamSynchronize(stream()), "waiting for the device"); }

CudaSpace::Loop::~Loop() {
  if (graph_ != nullptr) cudaGraphExecDestroy(graph_);
  for (cudaEvent_t event : event_)
    if (event != nullptr) cudaEventDestroy(event);
  cudaFreeHost(flag_);
}

void CudaSpace::Loop::begin_recording() {
  scratch();  // memory is taken before the recording
  if (flag_ == nullptr) {
    check(cudaHostAlloc(&flag_, 2 * sizeof(int), cudaHostAllocDefault), "taking memory of the host");
    for (cudaEvent_t& event : event_)
      check(cudaEventCreateWithFlags(&event, cudaEventDisableTiming), "making an event");
  }
  if (graph_ != nullptr) cudaGraphExecDestroy(std::exchange(graph_, nullptr));
  check(cudaStreamBeginCapture(stream(), cudaStreamCaptureModeThreadLocal), "recording a solve");
}

void CudaSpace::Loop::drop_recording() noexcept {
  cudaStreamCaptureStatus status = cudaStreamCaptureStatusNone;
  cudaStreamIsCapturing(stream(), &status);
  if (status == cudaStreamCaptureStatusNone) return;
  cudaGraph_t graph = nullptr;
  cudaStreamEndCapture(stream(), &graph);
  if (graph != nullptr) cudaGraphDestroy(graph);
  cudaGetLastError();
}

void CudaSpace::Loop::end_recording() {
  cudaGraph_t graph = nullptr;
  check(cudaStreamEndCapture(stream(), &graph), "recording a solve");
  const cudaError_t status = cudaGraphInstantiate(&graph_, graph, 0);
  cudaGraphDestroy(graph);
  check(status, "preparing a solve");
}

/// The flag of one chunk is looked at while the next one runs.
void CudaSpace::Loop::repeat(int times) {
  for (int i = 0; i < times; ++i) {
    check(cudaGraphLaunch(graph_, stream()), "starting a solve");
    check(cudaMemcpyAsync(flag_ + i % 2, done_, sizeof(int), cudaMemcpyDeviceToHost, stream()), "reading a flag");
    check(cudaEventRecord(event_[i % 2], stream()), "recording an event");
    if (i == 0) continue;
    check(cudaEventSynchronize(event_[(i - 1) % 2]), "waiting for a solve");
    if (flag_[(i - 1) % 2] != 0) return;
  }
}

}  // namespace fascia::gpu
