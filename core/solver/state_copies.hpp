#pragma once

#include "core/base/parallel_copy.hpp"
#include "core/structure/model.hpp"

#include <span>
#include <vector>

/// Copies of states, and zeros, by all threads, into what keeps its memory from step to step.
namespace fascia {

/// Copies matrices.
inline void copy_matrices(ThreadPool& pool, const FrameMatrices& from, FrameMatrices& to) {
  if (to.size() != from.size() || (to.data() == nullptr) != (from.data() == nullptr)) {
    to = from;
    return;
  }
  copy_parallel(pool, from.values(), std::span(to.begin(), to.end()));
}

/// Makes as many zeros as there are others.
inline void clear_as(ThreadPool& pool, const FrameMatrices& other, FrameMatrices& to) {
  if (to.size() != other.size() || (to.data() == nullptr) != (other.data() == nullptr))
    to = FrameMatrices(other.size(), other.data() != nullptr);
  clear_parallel(pool, std::span(to.begin(), to.end()));
}

template <class Item>
void clear_as(ThreadPool& pool, const std::vector<Vec3d>& other, std::vector<Item>& to) {
  to.resize(other.size());
  clear_parallel(pool, std::span(to));
}

/// Copies all of a state but its velocities and what constraints turned.
inline void copy_place(ThreadPool& pool, const State& from, State& to) {
  const auto& [u, D, v, Q_dot, turned, time, memory, factors] = from;  // no member is forgotten
  copy_into(pool, u, to.u);
  copy_matrices(pool, D, to.D);
  copy_into(pool, memory, to.memory);
  to.time = time;
  to.factors = factors;
}

}  // namespace fascia
