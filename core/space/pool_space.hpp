#pragma once

#include "core/base/thread_pool.hpp"
#include "core/space/space.hpp"

#include <vector>

namespace fascia {

/// The processor's memory, and loops on the threads of a pool; without one on the thread that calls. Sums are added in
/// the order of HostSpace: they do not depend on the number of threads. Loops over few items wake no other thread.
/// All that the body of a loop calls is inlined: a node's numbers would pass through memory from call to call.
class PoolSpace : public HostMemory {
 public:
  PoolSpace() = default;
  explicit PoolSpace(ThreadPool& pool) : pool_(&pool) {}

  /// The pool that it was given.
  ThreadPool& pool() const { return *pool_; }

  /// body(i) for i < count.
  template <class Body>
  void for_each(int count, const Body& body) const {
    const auto range = [&](int begin, int end) __attribute__((flatten)) {
      for (int i = begin; i < end; ++i) body(i);
    };
    ThreadPool::for_ranges_on(pool_, count, kGrain, range);
  }

  /// body(i, sums) for i < count, then once end(totals).
  template <int K, int M = 0, class Body, class End>
  void sum(int count, const Body& body, const End& end) const {
    using Total = Sums<K, M>;
    const int chunks = (count + kSumChunk - 1) / kSumChunk;
    const auto of_chunk = [&](int chunk) __attribute__((flatten, noinline)) {  // one copy, as in ThreadPool
      Total part;
      const int first = chunk * kSumChunk;
      for (int i = first; i < std::min(count, first + kSumChunk); ++i) body(i, part);
      return part;
    };
    Total total;
    if (pool_ == nullptr || chunks <= 1) {
      for (int c = 0; c < chunks; ++c) total.add(of_chunk(c));
    } else {
      sums_.resize(std::max(sums_.size(), static_cast<std::size_t>(chunks) * (sizeof(Total) / sizeof(double))));
      auto* parts = reinterpret_cast<Total*>(sums_.data());
      pool_->for_chunks(chunks, [&](int c) { parts[c] = of_chunk(c); });
      for (int c = 0; c < chunks; ++c) total.add(parts[c]);
    }
    end(total);
  }

 private:
  static constexpr int kGrain = 256;  ///< items that one thread takes at once

  ThreadPool* pool_ = nullptr;
  mutable std::vector<double> sums_;  ///< of chunks
};

}  // namespace fascia
