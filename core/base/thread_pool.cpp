#include "core/base/thread_pool.hpp"

#include "core/base/look.hpp"
#include "core/base/processors.hpp"

#include <chrono>

namespace fascia {

namespace {

constexpr int left(std::uint64_t open) { return static_cast<int>(static_cast<std::uint32_t>(open)); }

}  // namespace

ThreadPool::ThreadPool(int threads)
    : size_(threads > 0 ? threads : available_processors()),
      shares_(std::make_unique<Share[]>(static_cast<std::size_t>(size_))) {
  try {
    for (int i = 1; i < size_; ++i) workers_.emplace_back([this, i] { worker_loop(i); });
  } catch (...) {  // no memory for another stack, or no thread left (std::system_error): those that run must end first
    end_workers();
    throw;
  }
}

ThreadPool::~ThreadPool() { end_workers(); }

void ThreadPool::end_workers() {
  stop_ = true;
  ++calls_;
  calls_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void ThreadPool::run(int chunks, const void* work, Call call) {
  work_ = work;
  call_ = call;
  chunks_ = chunks;
  done_.store(0, std::memory_order_relaxed);
  const std::uint64_t loop = calls_.load(std::memory_order_relaxed) + std::uint64_t{1};
  int begin = 0;
  for (int s = 0; s < size_; ++s) {
    const auto end = static_cast<int>(static_cast<std::int64_t>(chunks) * (s + 1) / size_);
    shares_[s].end = end;
    shares_[s].open.store(loop << 32U | static_cast<std::uint32_t>(end - begin), std::memory_order_release);
    begin = end;
  }
  ++calls_;
  calls_.notify_all();
  work_from(0);
  const auto all_done = [&] { return done_.load(std::memory_order_acquire) == chunks; };
  if (look_for(all_done)) return;
  for (int done = done_.load(std::memory_order_acquire); done != chunks; done = done_.load(std::memory_order_acquire))
    done_.wait(done, std::memory_order_acquire);
}

/// Works at chunks until none is left: first those of a share, then of those behind it, in a circle.
void ThreadPool::work_from(int share) {
  int did = 0, chunks = 0;
  for (int s = 0; s < size_; ++s) {
    Share& from = shares_[(share + s) % size_];
    std::uint64_t open = from.open.load(std::memory_order_acquire);
    while (left(open) > 0) {
      // Succeeds only while the loop that it read still has that chunk to give, which therefore cannot end.
      if (!from.open.compare_exchange_weak(open, open - 1, std::memory_order_acq_rel, std::memory_order_acquire))
        continue;
      call_(work_, from.end - left(open));
      chunks = chunks_;
      ++did;
      open = from.open.load(std::memory_order_acquire);
    }
  }
  if (did > 0 && done_.fetch_add(did, std::memory_order_acq_rel) + did == chunks) done_.notify_one();
}

void ThreadPool::worker_loop(int share) {
  std::uint32_t seen = 0;
  while (true) {
    work_from(share);
    const auto called = [&] { return calls_.load(std::memory_order_acquire) != seen; };
    if (!look_for(called)) calls_.wait(seen, std::memory_order_acquire);
    seen = calls_.load(std::memory_order_acquire);
    if (stop_) return;
  }
}

}  // namespace fascia
