#include "core/base/thread_pool.hpp"

#include <sched.h>

#include <algorithm>
#include <chrono>

namespace fascia {

int available_processors() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  // Fails where the machine has more processors than the set: then all count.
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return std::max(1, CPU_COUNT(&allowed));
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

namespace {

/// How long a thread looks before it sleeps: some times what waking one costs, so that loops that follow one another
/// find their threads awake, and little beside what they save where they do not.
constexpr std::chrono::microseconds kLook{20};

/// Looks until `found()`, at most kLook long, and lets other processes have their turn meanwhile; whether it was found.
template <class Found>
bool look(const Found& found) {
  constexpr int kLooksBetweenTurns = 64;
  const auto end = std::chrono::steady_clock::now() + kLook;
  do {
    for (int i = 0; i < kLooksBetweenTurns; ++i)
      if (found()) return true;
    std::this_thread::yield();
  } while (std::chrono::steady_clock::now() < end);
  return false;
}

}  // namespace

ThreadPool::ThreadPool(int threads) {
  const int count = threads > 0 ? threads : available_processors();
  try {
    for (int i = 1; i < count; ++i) workers_.emplace_back([this] { worker_loop(); });
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
  const std::uint64_t loop = (open_.load(std::memory_order_relaxed) >> 32U) + 1;
  open_.store(loop << 32U | static_cast<std::uint32_t>(chunks), std::memory_order_release);
  ++calls_;
  calls_.notify_all();
  while (take_chunk()) {
  }
  const auto all_done = [&] { return done_.load(std::memory_order_acquire) == chunks; };
  if (look(all_done)) return;
  for (int done = done_.load(std::memory_order_acquire); done != chunks; done = done_.load(std::memory_order_acquire))
    done_.wait(done, std::memory_order_acquire);
}

// The exchange succeeds only while the loop that it read still has that chunk to give, which therefore cannot end.
bool ThreadPool::take_chunk() {
  std::uint64_t open = open_.load(std::memory_order_acquire);
  do {
    if (static_cast<std::uint32_t>(open) == 0) return false;
  } while (!open_.compare_exchange_weak(open, open - 1, std::memory_order_acq_rel, std::memory_order_acquire));
  const int chunks = chunks_;
  call_(work_, chunks - static_cast<int>(static_cast<std::uint32_t>(open)));
  if (done_.fetch_add(1, std::memory_order_acq_rel) + 1 == chunks) done_.notify_one();
  return true;
}

void ThreadPool::worker_loop() {
  std::uint32_t seen = 0;
  while (true) {
    while (take_chunk()) {
    }
    const auto called = [&] { return calls_.load(std::memory_order_acquire) != seen; };
    if (!look(called)) calls_.wait(seen, std::memory_order_acquire);
    seen = calls_.load(std::memory_order_acquire);
    if (stop_) return;
  }
}

}  // namespace fascia
