#pragma once

#include "core/executor/executor.hpp"
#include "core/solver/newton.hpp"
#include "core/solver/reached.hpp"
#include "core/solver/state_copies.hpp"
#include "core/solver/step_system.hpp"
#include "core/tangent/tangent_solver.hpp"

#include <array>
#include <span>
#include <vector>

namespace fascia {

/// Both directions of path following, in world axes: K d_r = −r, K d_f = −∂r/∂λ. What is prescribed moves along.
struct PathDirections {
  bool usable = false;  ///< K is not singular to rounding
  int unstable = 0;     ///< negative pivots of K: directions in which the equilibrium is unstable
  std::vector<double> d_r, d_f;
  double largest_rotation = 0;  ///< in d_f [rad]
};

/// A step that another system takes, in the midst of Newton's method.
struct StepInProgress {
  State start;
  State increment;  ///< since then, in u, D and turned
  StepConstants step;
  std::vector<PoseMotion> q, w;   ///< of the scheme; empty: of implicit Euler's rule
  StrainHistory history;          ///< of the viscous stress
  std::vector<double> factors;    ///< of all schedules
  std::vector<double> pressures;  ///< of surfaces, that Newton's method follows
  TakenStep taken;                ///< that led to the present state; without entries where none did
};

/// Types of a StepSystem on the processor.
struct PoolStep {
  using Space = PoolSpace;
  using Pose = State;
  using Memory = StepMemory;
  using History = StrainHistory;
  using Vector = std::vector<double>;
  using Mark = EndMark;
};

class MechanicalSystem;
extern template class StepSystem<MechanicalSystem, PoolStep>;

/// A step on the processor: forces by its executor, directions by its linear solvers. Loads without a potential are
/// counted by the work that they do, so that energies of states are comparable.
class MechanicalSystem : public StepSystem<MechanicalSystem, PoolStep> {
 public:
  MechanicalSystem(const Model& model, ThreadPool& pool, const SolverSettings& settings);

  /// StepSystem forgets its steps, and linear solvers forget what they have learned.
  void begin_afresh(std::span<const double> factors, const std::vector<double>& pressures);
  void forget_steps(std::span<const double> factors, const std::vector<double>& pressures);

  // Newton asks for these beside StepSystem.
  /// @param most_iterations  of conjugate gradients, where the settings allow as many
  DirectionReport direction(int most_iterations = kAsManyAsNeeded);
  /// The part of a step along the direction that may be taken, at most the one that is wanted: user blocks may have no
  /// energy beyond (UserBlock::largest_step()).
  double largest_step(double wanted);
  bool has_prescribed_increment();
  /// Energies of states are comparable: of loads without a potential, the energy of an evaluation has the work that
  /// they did since the start of the step.
  static constexpr bool compares_energies() { return true; }

  /// Stability of the equilibrium that the last step of statics found, which the system still stands at.
  /// @param end   as finish_step() returned it
  /// @param made     iterations of CG in the run so far
  /// @param current  the last direction was that of a correction too small to matter
  Stability stability(const State& end, long made, bool current);

  /// Condition of the tangent at the state of the last evaluation; see TangentSolver::condition().
  TangentCondition condition(double most_flops);

  // What path following asks for (path_system.cpp).
  /// At the present state, which was evaluated. @param ahead, behind  factors at two load factors `width` apart
  PathDirections path_directions(std::span<const double> ahead, std::span<const double> behind, double width);
  /// Makes weight d_r + rate d_f the direction that apply() takes; returns its largest rotation [rad].
  double steer(const PathDirections& directions, double weight, double rate);
  /// From now on residuals are judged by the loads of the last evaluation too: on a path they pass through zero.
  void keep_loads();
  /// Displacements since the start of the step [m].
  std::span<const Vec3d> step_displacement() const { return increment_.u; }

  /// K d at the state of the last evaluation, by degrees of freedom in world axes.
  std::vector<double> product(std::span<const double> d);

  /// Reads what acts at the last evaluation. (reached_state.cpp)
  /// @param state  that was reached, where tethers pull
  void read(const ReachedParts& parts, const State& state, ReachedForces& out);

  /// Stands where another system does within its step, for direction() and levels().
  void stand_in(const StepInProgress& step);
  /// y += what the tangent of loads without a potential has beside its symmetric part, of x, at the state where
  /// linearize_loads() was called last; in constraint axes.
  void add_unsymmetric(std::span<const double> x, std::span<double> y);
  void linearize_loads();
  /// Levels of rigid frames of the tangent at the present state, for solves elsewhere; null where one of them is not
  /// positive definite. @param material  of the tangent without all that stress does
  const Multigrid* levels(bool material);
  /// By degrees of freedom in world axes.
  std::span<const double> last_direction() const { return direction_; }

  /// Largest rotation [rad] by which a boundary motion would turn a frame from its present place.
  double prescribed_rotation() const;

  const State& state() const { return now_; }
  /// Gradient of the internal energy, loads and inertia: what supports add to hold the model (by degrees of freedom).
  /// Forces on dependent nodes are on their hosts.
  std::span<const double> gradient() const { return gradient_; }
  /// Forces on dependent nodes, in the order of PointSet::dependents: for each the force with which its hosts hold it
  /// and, where it turns, their torque about it (dependents × 6) [N], [N m]. They are the gradient before it went to
  /// the hosts.
  std::span<const double> dependent_forces() const { return dependent_forces_; }
  double load_energy() const { return load_energy_; }  ///< potential of dead loads and closed surfaces [J]
  const CpuExecutor& executor() const { return executor_; }
  CpuExecutor& executor() { return executor_; }
  /// At the state of the last evaluation.
  const Surfaces<PoolSpace>& surfaces() const { return moving_.surfaces; }
  TangentSolver& linear() { return tangent_; }

 private:
  friend class StepSystem<MechanicalSystem, PoolStep>;
  // StepSystem calls these.
  void step_began();
  void place_tethers() { fascia::place_tethers(model_, factors_, executor_.targets()); }
  void release_tethers();
  void store_strain(const State& state, AlignedVector<double>& E) { executor_.store_strain(state, E); }
  void store_stress(const State& state, std::span<const double> given, std::span<double> out) {
    executor_.store_stress(state, given, out);
  }
  void store_stretches(Vec3d* stretch) const;
  void stretch_tethers(const std::array<double, 3>& weights);
  Evaluation evaluate_anew();
  void evaluate_unjudged();
  void evaluate_loads();
  double* scratch() { return work_.data(); }
  void note_step(double step);
  void step_saved() { saved_work_ = load_work_; }
  void step_restored();

  std::vector<PartForces> forces_of_parts();
  double load_power() const;
  std::span<const double> surface_figures() const {
    return {moving_.surfaces.figures(), moving_.surfaces.figure_count()};
  }
  void add_surface_tangent(Linearization& lin);
  void add_loads_and_inertia();
  void find_prescribed(std::span<const double> factors, std::span<double> local);
  double largest_rotation_in(std::span<const double> vector) const;
  void add_node_blocks(Linearization& lin, bool turning = true);

  CpuExecutor executor_;
  TangentSolver tangent_;
  bool linear_, extrapolates_;
  TakenStep taken_;
  bool has_taken_ = false;  ///< a step of Newton's method led to the present state

  std::vector<double> work_;
  std::vector<double> node_sums_;   ///< (parts × kNodeQuantities)
  std::vector<double> prescribed_;  ///< what is still to go, in constraint axes
  std::vector<double> kept_loads_;  ///< by part, see keep_loads(); empty: none [N²]
  double relative_ = 1;             ///< residual of the last evaluation, relative
  /// Numbers of loads without a potential, whose work along a step is by the mean of their forces at its ends: the work
  /// where the state was saved [J]; the length of a step whose end was not evaluated yet; where the direction starts,
  /// their work along it and their potential [J].
  double saved_work_ = 0, applied_ = 0, start_power_ = 0, start_potential_ = 0;
  Linearization lin_;
};

/// A step of a system, which was evaluated there.
class SystemStep final : public ReachedStep {
 public:
  SystemStep(MechanicalSystem& system, const State& state) : system_(system), state_(state) {}
  InternalEnergy energy() const override { return system_.internal_energy(); }
  const State& state() override { return state_; }
  void read(const ReachedParts& parts, ReachedForces& out) override { system_.read(parts, state_, out); }

 private:
  MechanicalSystem& system_;
  const State& state_;
};

}  // namespace fascia
