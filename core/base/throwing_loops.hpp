#pragma once

#include "core/base/thread_pool.hpp"

#include <exception>
#include <mutex>

namespace fascia {

/// Loops as ThreadPool::for_ranges() over work that may throw, as it does where memory ends: all ranges are gone
/// through, then what the first of those that threw has thrown goes on to the caller, whatever the number of threads.
template <class Work>
void for_throwing_ranges(ThreadPool& pool, int items, int grain, const Work& work) {
  std::exception_ptr thrown;
  int thrown_at = items;
  std::mutex throwing;
  pool.for_ranges(items, grain, [&](int begin, int end) {
    try {
      work(begin, end);
    } catch (...) {
      const std::lock_guard lock(throwing);
      if (begin >= thrown_at) return;
      thrown = std::current_exception();
      thrown_at = begin;
    }
  });
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace fascia
