#pragma once

#include "core/base/portability.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>

/// Where arrays live and loops run. A loop over the nodes of a model is written once, for a space: PoolSpace
/// (pool_space.hpp), the threads of a processor; CudaSpace (gpu/space/cuda_space.cuh), a device; or HostSpace, one
/// thread, which serves as the device's test where there is none.
///
/// A loop's body is a function object of values and pointers into the space, called for each index in any order.
namespace fascia {

/// K sums and M maxima of values that are not negative, which a loop builds up.
template <int K, int M = 0>
struct Sums {
  double v[std::max(K, 1)]{};
  double largest[std::max(M, 1)]{};

  FASCIA_HD void add(const Sums& other) {
    for (int k = 0; k < K; ++k) v[k] += other.v[k];
    for (int k = 0; k < M; ++k) note(k, other.largest[k]);
  }
  /// A value that is not a number stays.
  FASCIA_HD void note(int k, double value) {
    if (!(value <= largest[k]) && largest[k] == largest[k]) largest[k] = value;
  }
};

/// Lanes of a loop whose items are eight each, as groups of points are.
inline constexpr int kSpaceLanes = 8;

/// The memory of a processor.
struct HostMemory {
  static constexpr bool kSeesHost = true;  ///< pointers to values of the host are pointers into the space

  static void* allocate(std::size_t bytes) { return bytes == 0 ? nullptr : ::operator new(bytes, kAlignment); }
  static void release(void* memory) noexcept { ::operator delete(memory, kAlignment); }
  static void copy_in(void* to, const void* from, std::size_t bytes) { copy(to, from, bytes); }
  static void copy_out(void* to, const void* from, std::size_t bytes) { copy(to, from, bytes); }
  static void copy(void* to, const void* from, std::size_t bytes) {
    if (bytes > 0) std::memcpy(to, from, bytes);
  }
  static void set_zero(void* memory, std::size_t bytes) {
    if (bytes > 0) std::memset(memory, 0, bytes);
  }

 private:
  static constexpr std::align_val_t kAlignment{64};
};

/// Items that a sum adds one after the other; such chunks are added in their order.
inline constexpr int kSumChunk = 256;

struct HostSpace : HostMemory {
  static constexpr bool kHasTiles = false;

  static void synchronize() {}

  /// body(i) for i < count.
  template <class Body>
  static void for_each(int count, const Body& body) {
    for (int i = 0; i < count; ++i) body(i);
  }

  /// body(i, sums) for i < count, then once end(totals). The order of additions depends on the count alone.
  template <int K, int M = 0, class Body, class End>
  static void sum(int count, const Body& body, const End& end) {
    Sums<K, M> total;
    for (int begin = 0; begin < count; begin += kSumChunk) {
      Sums<K, M> part;
      for (int i = begin; i < std::min(count, begin + kSumChunk); ++i) body(i, part);
      total.add(part);
    }
    end(total);
  }

  /// body(i, lane, sums) for the lanes of each i < count, then end(i, totals).
  template <int K, class Body, class End>
  static void sum_lanes(int count, const Body& body, const End& end) {
    for (int i = 0; i < count; ++i) {
      Sums<K> total;
      for (int lane = 0; lane < kSpaceLanes; ++lane) body(i, lane, total);
      end(i, total);
    }
  }

  /// Repeats a body of loops until one of them sets a flag.
  class Loop {
   public:
    /// @param key      of what the body does; another key, another body
    /// @param limit    times at most
    /// @param at_once  times that may follow each other without a look at the flag
    template <class Body>
    void run(std::uint64_t /*key*/, int limit, int /*at_once*/, const int* done, const Body& body) {
      for (int i = 0; i < limit && *done == 0; ++i) body();
    }
  };
};

}  // namespace fascia
