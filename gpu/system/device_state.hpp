#pragma once

#include "core/node/time_scheme.hpp"
#include "core/space/array.hpp"
#include "core/structure/model.hpp"

#include <array>
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
  /// Room for what points remember. @return false where the state had it
  bool begin_memory(std::size_t size) {
    if (memory.size() == size) return false;
    memory.resize(size);
    memory.set_zero();
    return true;
  }
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

}  // namespace fascia::gpu
