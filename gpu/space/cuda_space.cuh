#pragma once

#include "core/space/space.hpp"
#include "gpu/space/cuda_check.hpp"
#include "gpu/space/device.hpp"

#include <cuda_runtime.h>

#include <vector>

namespace fascia::gpu {

namespace kernels {

template <class Body>
__global__ void __launch_bounds__(256) for_each(int count, Body body) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < count) body(i);
}

/// Sums over a block's threads, in a fixed order; valid in thread 0.
template <int K, int M>
__device__ void block_sum(Sums<K, M>& s) {
  __shared__ Sums<K, M> part[32];
  const int lane = static_cast<int>(threadIdx.x & 31), warp = static_cast<int>(threadIdx.x >> 5);
  const auto warp_sum = [&] {
    for (int step = 16; step > 0; step >>= 1) {
      Sums<K, M> other;
      for (int k = 0; k < K; ++k) other.v[k] = __shfl_down_sync(0xffffffffu, s.v[k], step);
      for (int k = 0; k < M; ++k) other.largest[k] = __shfl_down_sync(0xffffffffu, s.largest[k], step);
      s.add(other);
    }
  };
  warp_sum();
  if (lane == 0) part[warp] = s;
  __syncthreads();
  if (warp == 0) {
    s = lane < static_cast<int>(blockDim.x >> 5) ? part[lane] : Sums<K, M>{};
    warp_sum();
  }
  __syncthreads();
}

/// Each block leaves its part; the last one to finish adds them up.
/// @param partial  (blocks × (K + M)), @param finished  0 before and after
template <int K, int M, class Body, class End>
__global__ void __launch_bounds__(256) sum(int count, Body body, End end, double* partial, unsigned* finished) {
  Sums<K, M> s;
  for (int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x); i < count;
       i += static_cast<int>(gridDim.x * blockDim.x))
    body(i, s);
  block_sum<K, M>(s);
  __shared__ bool last;
  if (threadIdx.x == 0) {
    double* own = partial + blockIdx.x * (K + M);
    for (int k = 0; k < K; ++k) own[k] = s.v[k];
    for (int k = 0; k < M; ++k) own[K + k] = s.largest[k];
    __threadfence();
    last = atomicInc(finished, gridDim.x - 1) == gridDim.x - 1;
  }
  __syncthreads();
  if (!last) return;
  __threadfence();
  Sums<K, M> total;
  for (unsigned b = threadIdx.x; b < gridDim.x; b += blockDim.x) {
    const volatile double* of = partial + b * (K + M);
    Sums<K, M> other;
    for (int k = 0; k < K; ++k) other.v[k] = of[k];
    for (int k = 0; k < M; ++k) other.largest[k] = of[K + k];
    total.add(other);
  }
  block_sum<K, M>(total);
  if (threadIdx.x == 0) end(total);
}

/// Eight neighbouring threads an item.
template <int K, class Body, class End>
__global__ void __launch_bounds__(256) sum_lanes(int count, Body body, End end) {
  const int thread = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  const int item = thread / kSpaceLanes, lane = thread % kSpaceLanes;
  Sums<K> s;
  if (item < count) body(item, lane, s);
  for (int k = 0; k < K; ++k)
    for (int step = kSpaceLanes / 2; step > 0; step >>= 1)
      s.v[k] += __shfl_down_sync(0xffffffffu, s.v[k], step, kSpaceLanes);
  if (item < count && lane == 0) end(item, s);
}

}  // namespace kernels

/// The default device; all loops of a thread follow each other on one stream, and what tiles do on the default stream.
struct CudaSpace {
  static constexpr bool kHasTiles = true;
  static constexpr bool kSeesHost = false;
  static cudaStream_t stream();
  static void* allocate(std::size_t bytes);
  static void release(void* memory) noexcept;
  static void copy_in(void* to, const void* from, std::size_t bytes);
  static void copy_out(void* to, const void* from, std::size_t bytes);
  static void copy(void* to, const void* from, std::size_t bytes);
  static void set_zero(void* memory, std::size_t bytes);
  static void synchronize();

  template <class Body>
  static void for_each(int count, const Body& body) {
    if (count == 0) return;
    const int threads = count < kSmall ? 64 : 256;
    kernels::for_each<<<blocks(count, threads), threads, 0, stream()>>>(count, body);
    check(cudaGetLastError(), "starting a kernel");
  }

  template <int K, int M = 0, class Body, class End>
  static void sum(int count, const Body& body, const End& end) {
    static_assert(K + M <= kMostSums);
    const int threads = count < kSmall ? 64 : 256;
    const unsigned grid = std::min(blocks(std::max(count, 1), threads), kMostBlocks);
    const Scratch& s = scratch();
    kernels::sum<K, M><<<grid, threads, 0, stream()>>>(count, body, end, s.partial, s.finished);
    check(cudaGetLastError(), "starting a sum");
  }

  template <int K, class Body, class End>
  static void sum_lanes(int count, const Body& body, const End& end) {
    if (count == 0) return;
    constexpr int kThreads = 128;
    kernels::sum_lanes<K><<<blocks(count, kThreads / kSpaceLanes), kThreads, 0, stream()>>>(count, body, end);
    check(cudaGetLastError(), "starting a sum");
  }

  /// Repetitions are recorded once as a graph of a few of them; the host looks at the flag while the next ones run.
  class Loop {
   public:
    Loop() = default;
    Loop(const Loop&) = delete;
    Loop& operator=(const Loop&) = delete;
    ~Loop();

    template <class Body>
    void run(std::uint64_t key, int limit, int at_once, const int* done, const Body& body) {
      if (limit <= 0) return;
      const int chunk = limit < at_once ? limit : at_once;
      if (graph_ == nullptr || key != key_ || chunk != chunk_ || done != done_) {
        const Recording recording(*this);
        for (int i = 0; i < chunk; ++i) body();
        end_recording();
        key_ = key;
        chunk_ = chunk;
        done_ = done;
      }
      repeat((limit + chunk - 1) / chunk);
    }

   private:
    /// Ends also where a loop could not be started.
    class Recording {
     public:
      explicit Recording(Loop& loop) : loop_(loop) { loop.begin_recording(); }
      ~Recording() { loop_.drop_recording(); }
      Recording(const Recording&) = delete;
      Recording& operator=(const Recording&) = delete;

     private:
      Loop& loop_;
    };
    void begin_recording();
    void end_recording();
    void drop_recording() noexcept;
    void repeat(int times);

    cudaGraphExec_t graph_ = nullptr;
    cudaEvent_t event_[2] = {nullptr, nullptr};
    int* flag_ = nullptr;  ///< in memory of the host that the device writes
    const int* done_ = nullptr;
    std::uint64_t key_ = 0;
    int chunk_ = 0;
  };

 private:
  static constexpr int kSmall = 100000, kMostSums = 16;
  static cudaStream_t make_stream();
  static constexpr unsigned kMostBlocks = 1024;
  struct Scratch {
    double* partial = nullptr;
    unsigned* finished = nullptr;
  };
  static const Scratch& scratch();
  static unsigned blocks(int count, int threads) { return static_cast<unsigned>((count + threads - 1) / threads); }
};

}  // namespace fascia::gpu
