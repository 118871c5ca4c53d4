#pragma once

#include "core/run/explicit_mode.hpp"
#include "core/run/explicit_nodes.hpp"
#include "core/solver/mechanical_system.hpp"
#include "core/tangent/dependents.hpp"

#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace fascia {

/// Steps a state by central differences, in place: one pass over points for the forces, one over nodes. What it needs
/// is allocated once. The state's v and Q_dot are read at the start and written by report_velocities().
class ExplicitStepper {
 public:
  /// @param factors  of all schedules at the start
  ExplicitStepper(MechanicalSystem& system, State& state, double dt, std::span<const double> factors);

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

  /// Of a node that is held, at the last call of report_velocities().
  PoseMotion held_acceleration(int node) const { return held_acceleration_[at(nodes_.constraint[at(node)])]; }

  double kinetic_energy() const { return kinetic_; }  ///< of nodes that nothing holds, at the last half step [J]
  /// Energy at the start, and the most that loads, boundaries and tethers have added [J].
  double given_energy() const { return start_energy_ + largest_work_; }
  /// The kinetic energy is finite and within what was given, with room for rounding and for coarse steps.
  bool is_sound() const;

 private:
  struct PlacedLoad {
    int schedule;
    NodeLoad load;
  };

  auto moving() {
    return std::tie(state_, velocity_, factors_, gradient_, follower_, last_increments_, history_, stepped_, kinetic_,
                    work_, largest_work_, last_step_, times_);
  }
  void place_loads();
  void update_forces();
  void add_forces(const State& state, std::vector<double>& gradient, std::vector<double>& follower);
  void start_velocities();
  void node_force(const ExplicitNode& at_node, int node, double* load, double* force) const;
  bool step_free_vertex(int node, ExplicitSums& sums);
  ExplicitNode node_at(int node) const;
  double tether_work(std::span<const double> factors);

  const Model& model_;
  CpuExecutor& executor_;
  const DofFilter& filter_;
  SurfaceLoads surfaces_;
  DependentNodes dependents_;
  State& state_;
  double last_step_;  ///< [s]
  LeapTimes times_;   ///< about the present step

  ExplicitNodes nodes_;
  std::vector<HalfStepVelocity> velocity_;  ///< at the last half step
  std::vector<int> load_begin_;             ///< by node
  std::vector<PlacedLoad> loads_, dependent_loads_;
  /// The last: of followers, of surface loads, and what comes from dependent nodes.
  std::vector<double> factors_, gradient_, follower_;
  std::vector<double> increments_, last_increments_;  ///< prescribed, in constraint axes
  std::vector<double> old_targets_;
  std::vector<Vec3d> old_forces_;  ///< of tethers
  StrainHistory history_;
  std::vector<ExplicitSums> chunk_sums_;
  std::vector<PoseMotion> held_acceleration_;  ///< of each constraint
  std::tuple<State, std::vector<HalfStepVelocity>, std::vector<double>, std::vector<double>, std::vector<double>,
             std::vector<double>, StrainHistory, bool, double, double, double, double, LeapTimes>
      saved_;
  std::vector<double> saved_targets_;
  std::optional<ExplicitMode> mode_;  ///< from the first stable_step() on
  bool stepped_ = false;
  double kinetic_ = 0, work_ = 0, largest_work_ = 0, start_energy_ = 0;
};

}  // namespace fascia
