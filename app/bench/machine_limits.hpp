#pragma once

#include "core/base/thread_pool.hpp"

#include <algorithm>
#include <cstddef>
#include <map>

namespace fascia::app {

/// Bytes a second: of reading; of copying; of updates, y ← y + a x. What is written counts as well as what is read.
struct MemoryRates {
  double read = 0, copy = 0, update = 0;

  /// The least time that so many bytes take [s]: no faster than reading alone, and all of them no faster than what
  /// reads and writes.
  double seconds(double read_bytes, double written_bytes) const {
    return std::max(read_bytes / read, (read_bytes + written_bytes) / std::max({read, copy, update}));
  }
};

/// Bytes of all caches of the last level, as the system names them; 0 where it does not.
double last_level_cache();

/// How fast this machine reads, writes and multiplies, measured with the threads of a pool: the limits that kernels
/// are held against. Each thread works on its own share, which it touched first, many times in a row, so that nothing
/// is lost to waking threads. Rates are the best of some trials.
class MachineLimits {
 public:
  /// @param trials  of each rate, at least
  explicit MachineLimits(ThreadPool& pool, int trials = 7);

  int threads() const { return pool_.size(); }

  /// Rates where all threads together work on so many bytes: those of the cache that holds them. Sizes are rounded to
  /// half a power of two, and to some times the last cache, beyond which they are those of the main memory.
  const MemoryRates& memory(double bytes);
  const MemoryRates& main_memory() { return memory(largest_); }

  /// Multiplications and additions a second in vector registers of this build, fused where it has that: independent
  /// chains of y ← a y + b.
  double flops() const { return flops_; }

  /// Sizes of which rates are known, with these.
  const std::map<double, MemoryRates>& measured() const { return rates_; }
  double largest() const { return largest_; }

 private:
  MemoryRates measure(std::size_t doubles);
  double measure_flops();
  template <class Work>
  double best_seconds(const Work& work);

  ThreadPool& pool_;
  int trials_;
  double largest_ = 0;  ///< [bytes]
  double flops_ = 0;
  std::map<double, MemoryRates> rates_;
};

}  // namespace fascia::app
