#pragma once

#include "core/node/time_scheme.hpp"
#include "core/space/array.hpp"
#include "core/structure/model.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace fascia::gpu {

/// A State in a space. Where no node turns, D and Q_dot are empty.
template <class Space>
struct DeviceState {
  Array<Space, Vec3d> u, v;
  Array<Space, Mat3d> D, Q_dot;
  Array<Space, double> turned;  ///< (constraints × 3)
  Array<Space, double> memory;  ///< as State has it
  std::vector<double> factors;  ///< likewise
  double time = 0;
  long step = 0;  ///< of the system that reached it; 0: another

  DeviceState() = default;
  explicit DeviceState(const State& state) { upload(state); }
  DeviceState(const DeviceState& other) { *this = other; }
  DeviceState(DeviceState&&) noexcept = default;
  DeviceState& operator=(DeviceState&&) noexcept = default;
  ~DeviceState() = default;
  DeviceState& operator=(const DeviceState& other) {
    if (this == &other) return *this;
    u.copy_from(other.u);
    v.copy_from(other.v);
    D.copy_from(other.D);
    Q_dot.copy_from(other.Q_dot);
    turned.copy_from(other.turned);
    memory.copy_from(other.memory);
    factors = other.factors;
    time = other.time;
    step = other.step;
    return *this;
  }

  void upload(const State& state) {
    u.upload(state.u);
    v.upload(state.v);
    D.upload(state.D.values());
    Q_dot.upload(state.Q_dot.values());
    turned.upload(std::span(state.turned.empty() ? nullptr : state.turned[0].data(), 3 * state.turned.size()));
    memory.upload(state.memory);
    factors = state.factors;
    time = state.time;
    step = 0;
  }
  /// @param state  of the same model
  void download(State& state) const {
    u.download(state.u);
    v.download(state.v);
    if (!D.empty()) D.download(std::span(&*state.D.begin(), D.size()));
    if (!Q_dot.empty()) Q_dot.download(std::span(&*state.Q_dot.begin(), Q_dot.size()));
    state.turned.resize(turned.size() / 3);
    if (!turned.empty()) turned.download(std::span(state.turned[0].data(), turned.size()));
    state.memory.resize(memory.size());
    memory.download(state.memory);
    state.factors = factors;
    state.time = time;
  }
};

// core/solver/state_copies.hpp has these for states of the host.
template <class Space>
void shape_place(const DeviceState<Space>& like, DeviceState<Space>& to) {
  to.u.resize(like.u.size());
  to.D.resize(like.D.size());
}
template <class Space>
void copy_place(const Space& /*space*/, const DeviceState<Space>& from, DeviceState<Space>& to) {
  to.u.copy_from(from.u);
  to.D.copy_from(from.D);
}
template <class Space>
void copy_turned(const DeviceState<Space>& from, DeviceState<Space>& to) {
  to.turned.copy_from(from.turned);
}
template <class Space>
void copy_motion(const Space& space, const DeviceState<Space>& from, DeviceState<Space>& to) {
  copy_place(space, from, to);
  to.v.copy_from(from.v);
  to.Q_dot.copy_from(from.Q_dot);
  copy_turned(from, to);
  to.factors = from.factors;
  to.time = from.time;
  to.step = from.step;
}
template <class Space>
void copy_increment(const Space& space, const DeviceState<Space>& from, DeviceState<Space>& to) {
  copy_place(space, from, to);
  copy_turned(from, to);
}
template <class Space>
void begin_increment(const Space& /*space*/, const DeviceState<Space>& start, DeviceState<Space>& to) {
  shape_place(start, to);
  to.u.set_zero();
  to.D.set_zero();
  copy_turned(start, to);
}
template <class Space>
void begin_turned(std::size_t constraints, DeviceState<Space>& state) {
  if (state.turned.size() == 3 * constraints) return;
  state.turned.resize(3 * constraints);
  state.turned.set_zero();
}
template <class Space>
bool begin_memory(std::size_t size, DeviceState<Space>& state) {
  if (state.memory.size() == size) return false;
  state.memory.resize(size);
  state.memory.set_zero();
  return true;
}
template <class Space>
void shape_end(const DeviceState<Space>& start, const DeviceState<Space>& increment, DeviceState<Space>& end) {
  shape_place(start, end);
  end.v.resize(start.u.size());
  end.Q_dot.resize(start.D.size());
  copy_turned(increment, end);
}

template <class Space>
void fetch_state(const DeviceState<Space>& from, State& to) {
  from.download(to);
}

/// Where a step ended, told by the number that its state has since then.
class StepMark {
 public:
  void forget() { known_ = 0; }
  template <class Space>
  void take(const Space& /*space*/, DeviceState<Space>& end, bool known) {
    end.step = ++steps_;
    known_ = known ? steps_ : 0;
  }
  template <class Space>
  bool is_at(const DeviceState<Space>& state) const {
    return known_ != 0 && state.step == known_;
  }

 private:
  long steps_ = 0, known_ = 0;
};

/// A StrainHistory in a space.
template <class Space>
struct DeviceHistory {
  Array<Space, double> E;
  double inverse_step = 0;
  std::span<const double> given{};  ///< in the space
};

/// A StepMemory in a space.
template <class Space>
struct DeviceMemory {
  double step = 0;
  Array<Space, PoseMotion> motion, velocity, acceleration;
  Array<Space, double> E;

  DeviceMemory() = default;
  explicit DeviceMemory(const StepMemory& memory) : step(memory.step) {
    motion.upload(memory.motion);
    velocity.upload(memory.velocity);
    acceleration.upload(memory.acceleration);
    E.upload(memory.E);
  }
  StepMemory downloaded() const {
    StepMemory memory{step, motion.downloaded(), velocity.downloaded(), acceleration.downloaded(), {}};
    memory.E.resize(E.size());
    E.download(memory.E);
    return memory;
  }
};

/// Types of a StepSystem in a space.
template <class S>
struct DeviceStep {
  using Space = S;
  using Pose = DeviceState<S>;
  using Memory = DeviceMemory<S>;
  using History = DeviceHistory<S>;
  using Vector = Array<S, double>;
  using Mark = StepMark;
};

}  // namespace fascia::gpu
