#include "core/cpu/thread_pool.hpp"

#include <sched.h>

#include <algorithm>

namespace fascia {

int available_processors() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  // Fails where the machine has more processors than the set: then all count.
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return std::max(1, CPU_COUNT(&allowed));
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

namespace {

void end_all(std::vector<std::thread>& workers, std::mutex& mutex, bool& stop, std::condition_variable& start) {
  {
    const std::lock_guard lock(mutex);
    stop = true;
  }
  start.notify_all();
  for (std::thread& worker : workers) worker.join();
}

}  // namespace

ThreadPool::ThreadPool(int threads) {
  const int count = threads > 0 ? threads : available_processors();
  try {
    for (int i = 1; i < count; ++i) workers_.emplace_back([this] { worker_loop(); });
  } catch (...) {  // no memory for another stack, or no thread left (std::system_error): those that run must end first
    end_all(workers_, mutex_, stop_, start_);
    throw;
  }
}

ThreadPool::~ThreadPool() { end_all(workers_, mutex_, stop_, start_); }

void ThreadPool::run(int chunks, const void* work, Call call) {
  {
    const std::lock_guard lock(mutex_);
    work_ = work;
    call_ = call;
    chunks_ = chunks;
    next_.store(0, std::memory_order_relaxed);
    busy_ = static_cast<int>(workers_.size());
    ++generation_;
  }
  start_.notify_all();
  take_chunks();
  std::unique_lock lock(mutex_);
  finished_.wait(lock, [this] { return busy_ == 0; });
}

void ThreadPool::take_chunks() {
  for (int c = next_.fetch_add(1); c < chunks_; c = next_.fetch_add(1)) call_(work_, c);
}

void ThreadPool::worker_loop() {
  int seen = 0;
  while (true) {
    {
      std::unique_lock lock(mutex_);
      start_.wait(lock, [&] { return stop_ || generation_ != seen; });
      if (stop_) return;
      seen = generation_;
    }
    take_chunks();
    const std::lock_guard lock(mutex_);
    if (--busy_ == 0) finished_.notify_one();
  }
}

}  // namespace fascia
