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
  constexpr std::size_t kGrain = std::max<std::size_t>(1, (1 << 15) / sizeof(To));  // 32 kB
  pool.for_chunks(static_cast<int>((from.size() + kGrain - 1) / kGrain), [&](int chunk) {
    const std::size_t begin = kGrain * static_cast<std::size_t>(chunk), end = std::min(from.size(), begin + kGrain);
    if constexpr (std::is_same_v<std::remove_const_t<From>, To>)
      std::copy(from.data() + begin, from.data() + end, to.data() + begin);
    else
      for (std::size_t i = begin; i < end; ++i) to[i] = static_cast<To>(from[i]);
  });
}

/// Copies an array likewise into one that keeps its memory from copy to copy.
template <class From, class To>
void copy_into(ThreadPool& pool, const From& from, To& to) {
  to.resize(from.size());
  copy_parallel(pool, std::span(from), std::span(to));
}

/// Sets all items to those of a new array, by all threads.
template <class Item>
void clear_parallel(ThreadPool& pool, std::span<Item> to) {
  constexpr int kGrain = std::max<int>(1, (1 << 15) / static_cast<int>(sizeof(Item)));
  pool.for_ranges(static_cast<int>(to.size()), kGrain,
                  [&](int begin, int end) { std::fill(to.begin() + begin, to.begin() + end, Item{}); });
}

}  // namespace fascia
