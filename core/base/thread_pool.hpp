#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace fascia {

/// Processors that this process may run on: fewer than the machine has under taskset, a batch system or a container.
int available_processors();

/// Threads that share the fixed chunks of a loop. Which thread takes a chunk varies, what a chunk computes does not.
/// A loop waits for its chunks, not for threads: one that the system keeps from running is not waited for unless it
/// holds a chunk. Between loops threads look for work for some microseconds, then sleep.
class ThreadPool {
 public:
  /// @param threads  0: as many as there are processors to run on
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int size() const { return static_cast<int>(workers_.size()) + 1; }

  /// Calls work(chunk) for each chunk in [0, chunks), in any order, and returns when all are done.
  /// `work` must not throw and must not call for_chunks itself.
  template <class Work>
  void for_chunks(int chunks, const Work& work) {
    if (chunks <= 1 || workers_.empty()) {
      for (int c = 0; c < chunks; ++c) work(c);
      return;
    }
    run(chunks, &work, [](const void* w, int c) { (*static_cast<const Work*>(w))(c); });
  }

  /// Calls work(begin, end) for consecutive ranges of at most `grain` items.
  template <class Work>
  void for_ranges(int items, int grain, const Work& work) {
    for_chunks((items + grain - 1) / grain, [&](int c) {
      const int begin = c * grain;
      work(begin, begin + grain < items ? begin + grain : items);
    });
  }

 private:
  using Call = void (*)(const void*, int);
  void run(int chunks, const void* work, Call call);
  bool take_chunk();
  void end_workers();
  void worker_loop();

  std::vector<std::thread> workers_;
  // Of the loop under way. Written while no chunk is left to take and none is being worked at; read after taking one.
  const void* work_ = nullptr;
  Call call_ = nullptr;
  int chunks_ = 0;
  /// Number of the loop, above, and its chunks that nobody has taken, in the lower 32 bits.
  std::atomic<std::uint64_t> open_{0};
  std::atomic<int> done_{0};
  /// Counts loops, and the end: what sleeping threads wait on.
  std::atomic<std::uint32_t> calls_{0};
  std::atomic<bool> stop_{false};
};

}  // namespace fascia
