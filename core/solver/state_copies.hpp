#pragma once

#include "core/base/parallel_copy.hpp"
#include "core/space/array.hpp"
#include "core/space/pool_space.hpp"
#include "core/structure/model.hpp"

#include <cstddef>
#include <span>
#include <vector>

/// Copies and zeros of what a step has, by all threads, into what keeps its memory from step to step. StepSystem calls
/// them of states and arrays of the host, and by the same names of those of another space
/// (gpu/system/device_state.hpp).
namespace fascia {

template <class T, class Allocator>
void copy_values(const PoolSpace& space, const std::vector<T, Allocator>& from, std::vector<T, Allocator>& to) {
  copy_into(space.pool(), from, to);
}
template <class T, class Allocator>
void clear_values(const PoolSpace& space, std::size_t size, std::vector<T, Allocator>& to) {
  to.resize(size);
  clear_parallel(space.pool(), std::span(to));
}
template <class Space, class T>
void copy_values(const Space& /*space*/, const Array<Space, T>& from, Array<Space, T>& to) {
  to.copy_from(from);
}
template <class Space, class T>
void clear_values(const Space& /*space*/, std::size_t size, Array<Space, T>& to) {
  to.resize(size);
  to.set_zero();
}

/// Makes room for as many matrices as there are others.
inline void shape_matrices(const FrameMatrices& like, FrameMatrices& to) {
  if (to.size() != like.size() || (to.data() == nullptr) != (like.data() == nullptr))
    to = FrameMatrices(like.size(), like.data() != nullptr);
}
inline void copy_matrices(const PoolSpace& space, const FrameMatrices& from, FrameMatrices& to) {
  shape_matrices(from, to);
  copy_parallel(space.pool(), from.values(), std::span(to.begin(), to.end()));
}

/// Makes room for u and D of as many nodes.
inline void shape_place(const State& like, State& to) {
  to.u.resize(like.u.size());
  shape_matrices(like.D, to.D);
}
inline void copy_place(const PoolSpace& space, const State& from, State& to) {
  copy_values(space, from.u, to.u);
  copy_matrices(space, from.D, to.D);
}
/// Copies a state without what points remember.
inline void copy_motion(const PoolSpace& space, const State& from, State& to) {
  const auto& [u, D, v, Q_dot, turned, time, memory, factors] = from;  // no member is forgotten
  copy_place(space, from, to);
  copy_values(space, v, to.v);
  copy_matrices(space, Q_dot, to.Q_dot);
  to.turned = turned;
  to.time = time;
  to.factors = factors;
}

/// Copies the increments of a step: u, D and turned.
inline void copy_increment(const PoolSpace& space, const State& from, State& to) {
  copy_place(space, from, to);
  to.turned = from.turned;
}
/// Makes those of a step that has just begun.
inline void begin_increment(const PoolSpace& space, const State& start, State& to) {
  shape_matrices(start.D, to.D);
  clear_values(space, start.u.size(), to.u);
  clear_parallel(space.pool(), std::span(to.D.begin(), to.D.end()));
  to.turned = start.turned;
}
/// A state that was made before the constraints has none of what they turned.
inline void begin_turned(std::size_t constraints, State& state) { state.turned.resize(constraints); }
/// Makes room for what points remember. @return  false where the state had it
inline bool begin_memory(std::size_t size, State& state) {
  if (state.memory.size() == size) return false;
  state.memory.assign(size, 0.0);
  return true;
}
/// Makes room for the end of a step, with what has turned until then.
inline void shape_end(const State& start, const State& increment, State& end) {
  shape_place(start, end);
  end.v.resize(start.u.size());
  shape_matrices(start.D, end.Q_dot);
  end.turned = increment.turned;
}
inline void copy_turned(const State& from, State& to) { to.turned = from.turned; }

/// Brings a state to the host.
inline void fetch_state(const State& from, State& to) { to = from; }

/// Where a step ended, told by what is there: callers may give another state.
class EndMark {
 public:
  void forget() { known_ = false; }
  /// @param known  false: it is not asked for again
  void take(const PoolSpace& space, State& end, bool known) {
    known_ = known;
    if (known) copy_place(space, end, end_);
  }
  bool is_at(const State& state) const {
    return known_ && end_.u == state.u && std::ranges::equal(end_.D.values(), state.D.values());
  }

 private:
  State end_;
  bool known_ = false;
};

}  // namespace fascia
