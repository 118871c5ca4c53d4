#pragma once

#include "core/base/portability.hpp"

#include <chrono>
#include <thread>

namespace fascia {

/// Looks until `found()`, for some times what waking a thread costs, and lets other processes have their turn
/// meanwhile; whether it was found. Threads that find their work this way need not be woken, and lose little where they
/// do not.
template <class Found>
bool look_for(const Found& found) {
  constexpr std::chrono::microseconds kLook{20};
  constexpr int kLooksBetweenTurns = 64;
  const auto end = std::chrono::steady_clock::now() + kLook;
  do {
    for (int i = 0; i < kLooksBetweenTurns; ++i) {
      if (found()) return true;
      wait_a_moment();
    }
    std::this_thread::yield();
  } while (std::chrono::steady_clock::now() < end);
  return false;
}

}  // namespace fascia
