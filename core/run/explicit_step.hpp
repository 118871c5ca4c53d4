#pragma once

#include "core/run/explicit_mode.hpp"
#include "core/run/explicit_nodes.hpp"
#include "core/solver/mechanical_system.hpp"
#include "core/step/dependents.hpp"
#include "core/step/explicit_view.hpp"

#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace fascia {

/// Steps a state by central differences, in place: one pass over points for the forces, one over nodes. What it needs
/// is allocated once. The state's v and Q_dot are read at the start and written by report_velocities().
class ExplicitStepper {
 public:
  using Space = PoolSpace;
  using Pose = State;

  /// @param factors  of all schedules at the start
  ExplicitStepper(MechanicalSystem& system, State& state, double dt, std::span<const double> factors);
  ExplicitStepper(const ExplicitStepper&) = delete;
  ExplicitStepper& operator=(const ExplicitStepper&) = delete;

  /// How long the next step and those after it are [s].
  void set_step(double dt) { times_ = LeapTimes::between(last_step_, dt); }
  /// One step. @param factors  at its end
  void advance(std::span<const double> factors);
  /// The stable step at the present state, without a margin [s]; after a step.
  /// @param about  what it is about
  double stable_step(double about);
  /// Keeps all that steps change, and returns to it.
  void save();
  void restore();
  /// v and Q_dot at the present step: means of the half steps on both sides. @param factors  at the end of the next
  /// step
  void report_velocities(std::span<const double> factors);

  /// Accelerations of each constraint's node, at the last call of report_velocities().
  const std::vector<PoseMotion>& held_accelerations() const { return held_acceleration_; }

  double kinetic_energy() const { return kinetic_; }  ///< of nodes that nothing holds, at the last half step [J]
  /// Energy at the start, and the most that loads, boundaries and tethers have added [J].
  double given_energy() const { return start_energy_ + largest_work_; }
  /// The kinetic energy is finite and within what was given, with room for rounding and for coarse steps.
  bool is_sound() const;

  // ExplicitMode asks for these.
  const PoolSpace& space() const { return space_; }
  const Model& model() const { return model_; }
  int free_count() const { return filter_.free_count(); }
  State& pose() { return state_; }
  ExplicitView view();
  void keep_strain();
  void gather_acting(State& pose, double inverse_step, double* out);
  void place_dependents(State& pose) { dependents_.place(pose.u.data(), pose.D.data()); }
  /// Calls act.operator()<Frames>().
  template <class Act>
  void for_nodes(const Act& act) {
    if (state_.D.data() != nullptr)
      act.template operator()<true>();
    else
      act.template operator()<false>();
  }

 private:
  auto moving() {
    return std::tie(state_, half_v_, half_spin_, half_rate_, factors_, gradient_, load_, last_increments_, history_,
                    stepped_, kinetic_, work_, largest_work_, last_step_, times_);
  }
  void update_forces(const Fading& fading);
  void keep_memory(const Fading& fading);
  void add_forces(const State& state, std::vector<double>& gradient, std::vector<double>& load);
  void start_velocities();
  void find_increments(std::span<const double> factors);
  double tether_work(std::span<const double> factors);

  const Model& model_;
  CpuExecutor& executor_;
  const DofFilter& filter_;
  const PoolSpace& space_;
  const ModelView& seen_;
  Followers<PoolSpace> followers_;
  Surfaces<PoolSpace> surfaces_;
  Dependents<PoolSpace> dependents_;
  State& state_;
  double last_step_;  ///< [s]
  LeapTimes times_;   ///< about the present step

  ExplicitNodes nodes_;
  std::vector<Vec3d> half_v_, half_spin_;  ///< HalfStepVelocity at the last half step; the first alone of vertices
  std::vector<Mat3d> half_rate_;
  /// Those of schedules; of nodes, the last only where more than dead loads act.
  std::vector<double> factors_, gradient_, load_;
  std::vector<double> mode_gradient_, mode_load_;     ///< at states beside the present one
  std::vector<double> increments_, last_increments_;  ///< prescribed, in constraint axes
  std::vector<double> old_targets_;
  std::vector<Vec3d> old_forces_;  ///< of tethers
  StrainHistory history_;
  StressMemory<PoolSpace> memory_;
  AlignedVector<double> fading_;               ///< S_e at the present state
  std::vector<PoseMotion> held_acceleration_;  ///< of each constraint
  std::tuple<State, std::vector<Vec3d>, std::vector<Vec3d>, std::vector<Mat3d>, std::vector<double>,
             std::vector<double>, std::vector<double>, std::vector<double>, StrainHistory, bool, double, double, double,
             double, LeapTimes>
      saved_;
  std::vector<double> saved_targets_;
  std::optional<ExplicitMode<ExplicitStepper>> mode_;  ///< from the first stable_step() on
  bool stepped_ = false;
  double kinetic_ = 0, work_ = 0, largest_work_ = 0, start_energy_ = 0;
};

}  // namespace fascia
