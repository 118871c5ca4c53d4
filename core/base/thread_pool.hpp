#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

namespace fascia {

/// Threads that share the fixed chunks of a loop. Each begins with the same part of them in every loop, so that what it
/// read is near when it comes again, then takes what others have left. Which thread takes a chunk varies, what a chunk
/// computes does not. A loop waits for its chunks, not for threads: one that the system keeps from running is not
/// waited for unless it holds a chunk, or has yet to report those that it did. Between loops threads look for work for
/// some microseconds, then sleep.
class ThreadPool {
 public:
  /// @param threads  0: as many as there are processors to run on
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int size() const { return size_; }

  /// Calls work(chunk) for each chunk in [0, chunks), in any order, and returns when all are done.
  /// `work` must not throw and must not call for_chunks itself.
  template <class Work>
  void for_chunks(int chunks, const Work& work) {
    for_chunks_on(this, chunks, work);
  }

  /// Calls work(begin, end) for consecutive ranges of at most `grain` items.
  template <class Work>
  void for_ranges(int items, int grain, const Work& work) {
    for_ranges_on(this, items, grain, work);
  }

  /// Calls work(begin, end) likewise; without a pool the thread that calls does all.
  template <class Work>
  static void for_ranges_on(ThreadPool* pool, int items, int grain, const Work& work) {
    for_chunks_on(pool, (items + grain - 1) / grain, [&](int c) {
      const int begin = c * grain;
      work(begin, begin + grain < items ? begin + grain : items);
    });
  }

 private:
  using Call = void (*)(const void*, int);

  /// One copy for one thread and for many: of two, the compiler may round one otherwise, as where it chooses which
  /// product of a b + c d it fuses with the sum.
  template <class Work>
  static void for_chunks_on(ThreadPool* pool, int chunks, const Work& work) {
    if (chunks <= 1 || pool == nullptr || pool->size_ == 1) {
      for (int c = 0; c < chunks; ++c) call<Work>(&work, c);
      return;
    }
    pool->run(chunks, &work, call<Work>);
  }

  template <class Work>
  [[gnu::noinline]] static void call(const void* work, int chunk) {
    (*static_cast<const Work*>(work))(chunk);
  }

  static constexpr int kLine = 64;  ///< bytes that processors pass to one another at once

  /// Says which consecutive chunks of the loop under way one thread begins with.
  struct alignas(kLine) Share {
    /// Number of the loop, above, and the share's chunks that nobody has taken, in the lower 32 bits.
    std::atomic<std::uint64_t> open{0};
    int end = 0;  ///< the chunk after the last one
  };

  void run(int chunks, const void* work, Call call);
  void work_from(int share);
  void end_workers();
  void worker_loop(int share);

  int size_;
  std::vector<std::thread> workers_;
  std::unique_ptr<Share[]> shares_;
  // Of the loop under way. Written while no chunk is left to take and none is being worked at; a share's end before its
  // chunks are given. All are read after taking a chunk.
  alignas(kLine) const void* work_ = nullptr;
  Call call_ = nullptr;
  int chunks_ = 0;
  /// Counts loops, and the end: what sleeping threads wait on.
  std::atomic<std::uint32_t> calls_{0};
  std::atomic<bool> stop_{false};
  alignas(kLine) std::atomic<int> done_{0};  ///< chunks
};

}  // namespace fascia
