#pragma once

#include "core/run/explicit_steps.hpp"
#include "gpu/blocks/blocks.hpp"
#include "gpu/explicit/explicit_kernels.hpp"
#include "gpu/system/device_state.hpp"

#include <cstdint>
#include <span>

namespace fascia::gpu {

/// Steps of central differences with everything in the memory of a space. They are queued one after the other, and
/// nothing comes back before it is asked for.
template <class MemorySpace>
class ExplicitSystem : public ExplicitSteps<ExplicitSystem<MemorySpace>, DeviceStep<MemorySpace>> {
  using Base = ExplicitSteps<ExplicitSystem, DeviceStep<MemorySpace>>;

 public:
  using Space = MemorySpace;
  using typename Base::Pose;
  static constexpr int kLookEvery = 50;  ///< steps between looks at whether they are sound, which wait for them

  /// @param state    with velocities, at the start
  /// @param plan     of the steps
  /// @param factors  of all schedules at a time
  /// @throws InputError  where a node has no inertia
  ExplicitSystem(const Model& model, const State& state, const ExplicitPlan& plan, FactorFunction factors);

  /// At the present step, without viscous stress.
  InternalEnergy energy() { return energy(true); }

 private:
  friend Base;
  using Base::data_, Base::memory_, Base::model_, Base::pose_, Base::progress_;

  // ExplicitSteps calls these.
  static constexpr int kQueue = 128;           ///< steps whose factors are uploaded together
  static constexpr bool kKeepsForces = false;  ///< a recorded step finds them
  kernels::ExplicitBlocksView with_blocks(const ExplicitView& nodes) { return {nodes, blocks_.view()}; }
  template <class Body>
  void run_recorded(std::uint64_t key, const Body& body) {
    loop_.run(key, 1, 1, &progress_.data()->unsound, body);
  }
  void block_forces(const Pose& pose, const DeviceHistory<Space>& history) {
    blocks_.forces(data_.view().nodes, {pose.u.data(), pose.D.data()},
                   {.E = history.E.data(), .inverse_step = history.inverse_step, .given = history.given.data()},
                   nullptr);
  }
  template <bool Frames>
  void store_loads(const kernels::ExplicitBlocksView& s) {
    Space::for_each(s.m.nodes.count, kernels::GatherLoads<Frames>{s});
  }
  void store_strain(const Pose& pose, Array<Space, double>& E) {
    E.resize(blocks_.strain_size());
    blocks_.store_strain({pose.u.data(), pose.D.data()}, E.data());
  }
  void store_stress(const Pose& pose, std::span<const double> given, Array<Space, double>& out) {
    blocks_.store_stress({pose.u.data(), pose.D.data()}, given.data(), out.data());
  }
  double elastic_energy() { return energy(false).total(); }
  void place_tethers(std::span<const double> factors);
  void move_tethers(const Array<Space, double>& factors);
  void save_tethers() { saved_targets_.copy_from(blocks_.points().targets()); }
  void restore_tethers() { blocks_.points().targets().copy_from(saved_targets_); }

  InternalEnergy energy(bool faded);

  Blocks<Space> blocks_;
  typename Space::Loop loop_;
  Array<Space, Tether> tethers_;
  Array<Space, double> still_, energies_, saved_targets_;
};

}  // namespace fascia::gpu
