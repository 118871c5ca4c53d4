#pragma once

#include "core/run/explicit_steps.hpp"
#include "core/solver/mechanical_system.hpp"

#include <span>
#include <vector>

namespace fascia {

class ExplicitStepper;
extern template class ExplicitSteps<ExplicitStepper, PoolStep>;

/// Steps of central differences on the processor, with the executor of a system.
class ExplicitStepper : public ExplicitSteps<ExplicitStepper, PoolStep> {
 public:
  static constexpr int kLookEvery = 1;  ///< steps between looks at whether they are sound

  /// @param system   stays with the caller
  /// @param state    with velocities, at the start
  /// @param factors  of all schedules at a time
  /// @throws InputError  where a node has no inertia
  ExplicitStepper(MechanicalSystem& system, const State& state, const ExplicitPlan& plan, FactorFunction factors);

 private:
  friend class ExplicitSteps<ExplicitStepper, PoolStep>;
  // ExplicitSteps calls these.
  static constexpr int kQueue = 16;           ///< steps whose factors are found together
  static constexpr bool kKeepsForces = true;  ///< forces are not found again where they are known
  static ExplicitView with_blocks(const ExplicitView& nodes) { return nodes; }
  template <class Body>
  static void run_recorded(std::uint64_t /*key*/, const Body& body) {
    body();
  }
  void block_forces(const State& pose, const StrainHistory& history) {
    executor_.forces(pose, history, {gradient_.data(), gradient_.size()});
  }
  template <bool Frames>
  void store_loads(const ExplicitView& s) {
    space_.for_each(model_.node_count(), loops::StoreDeadLoads{s.m, {s.u, s.D}, s.load});
  }
  void store_strain(const State& pose, AlignedVector<double>& E) { executor_.store_strain(pose, E); }
  void store_stress(const State& pose, std::span<const double> given, std::span<double> out) {
    executor_.store_stress(pose, given, out);
  }
  double elastic_energy();
  void place_tethers(std::span<const double> factors);
  void move_tethers(const Array<PoolSpace, double>& factors);
  void save_tethers();
  void restore_tethers();

  CpuExecutor& executor_;
  std::vector<double> old_targets_, saved_targets_;
  std::vector<Vec3d> old_forces_;  ///< of tethers
};

}  // namespace fascia
