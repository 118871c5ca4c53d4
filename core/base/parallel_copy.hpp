#pragma once

#include "core/base/thread_pool.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>

namespace fascia {

/// Copies numbers, converted to the type of `to`, by all threads of a pool: `to` is as long as `from`.
template <class From, class To>
void copy_parallel(ThreadPool& pool, std::span<From> from, std::span<To> to) {
  constexpr std::size_t kGrain = 4096;
  pool.for_chunks(static_cast<int>((from.size() + kGrain - 1) / kGrain), [&](int chunk) {
    const std::size_t begin = kGrain * static_cast<std::size_t>(chunk), end = std::min(from.size(), begin + kGrain);
    if constexpr (std::is_same_v<std::remove_const_t<From>, To>)
      std::copy(from.data() + begin, from.data() + end, to.data() + begin);
    else
      for (std::size_t i = begin; i < end; ++i) to[i] = static_cast<To>(from[i]);
  });
}

}  // namespace fascia
