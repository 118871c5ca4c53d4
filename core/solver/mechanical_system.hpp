#pragma once

#include "core/executor/executor.hpp"
#include "core/node/time_scheme.hpp"
#include "core/solver/boundary_motion.hpp"
#include "core/solver/newton.hpp"
#include "core/solver/reached.hpp"
#include "core/space/part_sums.hpp"
#include "core/space/pool_space.hpp"
#include "core/step/dependents.hpp"
#include "core/step/followers.hpp"
#include "core/step/model_data.hpp"
#include "core/step/step_view.hpp"
#include "core/step/stress_memory_steps.hpp"
#include "core/step/surfaces.hpp"
#include "core/structure/inertia.hpp"
#include "core/structure/model.hpp"
#include "core/tangent/tangent_solver.hpp"

#include <optional>
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
  StepForm form;
  StrainHistory history;          ///< of the viscous stress
  std::vector<double> factors;    ///< of all schedules
  std::vector<double> pressures;  ///< of surfaces, that Newton's method follows
  TakenStep taken;                ///< that led to the present state; without entries where none did
};

/// The equilibrium of a model in a load or time step, as Newton's method sees it: internal energy, loads, and in
/// dynamics the inertia of the step as a potential (incremental potential), in the form of time_scheme.hpp.
///
/// The unknown of a step is the motion since its start: u = u₀ + du, Q = (I + Ds) Q₀, A = A₀ + Ds. Velocities come from
/// du and Ds, never from a difference of positions, so that small steps keep their digits.
class MechanicalSystem {
 public:
  using Pose = State;
  using Memory = StepMemory;

  MechanicalSystem(const Model& model, ThreadPool& pool, const SolverSettings& settings);

  /// Starts a step of implicit Euler from `start`. @param dt  0: statics
  void begin_step(const State& start, double dt) { begin_step(start, dt, TimeScheme::implicit_euler, {}); }
  /// Starts a step of a scheme. @param memory  of the step before, as far as the scheme needs it
  void begin_step(const State& start, double dt, TimeScheme scheme, const StepMemory& memory);
  /// Loads and boundary motions where the step's equations hold (midpoint: in its middle, else at its end): one factor
  /// for each schedule.
  void set_factors(std::span<const double> factors);
  /// Loads and boundary motions of the model at rest: none, wherever drivers start their motions.
  void set_rest();
  /// Starts Newton where the old velocities lead, if the step's potential is lower there than at the old state.
  void start_from_prediction();
  /// Reads anew the motions that a driver gives, which start at their factor 0. Before the step's factors are set.
  void restart_motions();
  /// Goes on from a state as if it had been given it: what comes next depends on that state, the memory of its step,
  /// and what is said here alone.
  /// @param factors    of schedules at that state
  /// @param pressures  reached_pressures() there; empty: none
  void begin_afresh(std::span<const double> factors, const std::vector<double>& pressures);
  /// Does so but for what linear solvers have learned.
  void forget_steps(std::span<const double> factors, const std::vector<double>& pressures);
  /// Factors of schedules at the end of the last step.
  const std::vector<double>& reached_factors() const { return reached_factors_; }
  /// Newton's pressures of enclosed volumes at the end of the last step [Pa].
  std::vector<double> reached_pressures() const {
    return surfaces_.empty() ? std::vector<double>{} : surfaces_.reached();
  }

  /// The state at the end of the step, with its velocities. Of a midpoint step the factors must be set to those of the
  /// end before; what is prescribed then is on its target.
  /// @param end  takes it in place: it keeps its memory from step to step
  void finish_step(double end_time, StepMemory& memory, State& end);
  void finish_step(double end_time, State& end) {
    StepMemory unused;
    finish_step(end_time, unused, end);
  }
  /// Accelerations from the equation of motion at a state (Newmark's start), zero where a node has no inertia and in
  /// what is prescribed. The factors must be set to those of its time. @param dt  of the step to come
  void start_acceleration(const State& start, double dt, StepMemory& memory);

  // What Newton asks for.
  Evaluation evaluate();
  /// @param most_iterations  of conjugate gradients, where the settings allow as many
  DirectionReport direction(int most_iterations = kAsManyAsNeeded);
  /// The part of a step along the direction that may be taken, at most the one that is wanted: user blocks may have no
  /// energy beyond (UserBlock::largest_step()).
  double largest_step(double wanted);
  void apply(double step);
  void save();
  void restore();
  bool has_prescribed_increment();
  bool conservative() const { return conservative_; }
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
  std::span<const Vec3d> step_displacement() const { return increment_.du; }

  /// Adds to the gradient what accelerated supports carry of their own mass, which a state at rest does not show.
  /// @param acceleration  of each constraint: of its node's origin and Q or A
  void add_held_inertia(std::span<const PoseMotion> acceleration);

  /// K d at the state of the last evaluation, by degrees of freedom in world axes.
  std::vector<double> product(std::span<const double> d);

  // Evaluations of states that no step's equations hold at (reached_state.cpp). The gradient is what acts there: with
  // the viscous stress and the mass damping of what is held, without inertia. Energies are those of the state at rest.
  /// The strain rate comes from strains along the velocities, a time h ahead and behind. @param h  0: no viscous stress
  void look_at(const State& state, double h);
  /// After a midpoint step: the state at its end, with what accelerated supports carry. The strain rate comes from the
  /// strains of three states, since velocities of the midpoint rule ring where strong damping starts at once; tethers
  /// pull as in the middles of the last two steps, since stiff ones ring too.
  /// @param before   the state at its start
  /// @param earlier  the one as long before that, or empty: the strain rate is then that of the middle of the step
  void look_back(const State& state, const State& before, const State& earlier, double dt);

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

  /// The step's equations hold in its middle: after finish_step() the gradient is not that of the end.
  bool solves_for_middle() const { return form_.scheme == TimeScheme::midpoint; }

  const State& state() const { return state_; }
  std::span<const double> factors() const { return factors_; }
  /// Gradient of the internal energy, loads and inertia: what supports add to hold the model (by degrees of freedom).
  /// Forces on dependent nodes are on their hosts.
  std::span<const double> gradient() const { return gradient_; }
  /// Forces on dependent nodes, in the order of PointSet::dependents: for each the force with which its hosts hold it
  /// and, where it turns, their torque about it (dependents × 6) [N], [N m]. They are the gradient before it went to
  /// the hosts.
  std::span<const double> dependent_forces() const { return dependent_forces_; }
  InternalEnergy internal_energy() const { return internal_; }
  double load_energy() const { return load_energy_; }  ///< potential of dead loads and closed surfaces [J]
  const CpuExecutor& executor() const { return executor_; }
  CpuExecutor& executor() { return executor_; }
  const Model& model() const { return model_; }
  const DofFilter& filter() const { return filter_; }
  /// Where loops over nodes run, and the view that they have, with the factors set last.
  const PoolSpace& space() const { return space_; }
  const ModelView& nodes() const { return data_.view(); }
  /// At the state of the last evaluation.
  const Surfaces<PoolSpace>& surfaces() const { return surfaces_; }
  TangentSolver& linear() { return tangent_; }

 private:
  /// Increments of a step, which change in it, for save() and restore().
  struct Increment {
    std::vector<Vec3d> du;
    FrameMatrices Ds;
    std::vector<std::array<double, 3>> turned;  ///< as in State
  };
  std::vector<PartForces> forces_of_parts();
  double energy_at_start();
  void rebuild_state();
  void note_step(double step);
  void evaluate_loads();
  double load_power() const;
  std::span<const double> surface_figures() const { return {surfaces_.figures(), surfaces_.figure_count()}; }
  void add_surface_tangent(Linearization& lin);
  void place_dependents(State& state) const { dependents_.place(state.u.data(), state.D.data()); }
  void place_dependent_rates(State& state) const { dependents_.place_rates(state.v.data(), state.Q_dot.data()); }
  void place_dependents_of_step();
  void add_loads_and_inertia();
  void predict_strain(const StepMemory& memory);
  void give_memory(const Fading& fading);
  void act(std::span<const double> factors);
  void keep_memory(State& state);
  void rest_as_it_is(State& state);
  void store_strain_at(State state, StrainHistory& history);
  /// Runs a loop over the strains of a history.
  template <class Loop>
  void for_strains(const Loop& loop) {
    space_.for_each(static_cast<int>(history_.E.size()), loop);
  }
  void evaluate_reached(std::span<const double> targets);
  void add_support_inertia(const State& before, double inverse_dt);
  void note_stretches();
  State moved_by_velocity(double time);
  void find_prescribed(std::span<const double> factors, std::span<double> local);
  StepView step_view();
  ForceView force_view();
  double largest_rotation_in(std::span<const double> vector) const;
  void add_node_blocks(Linearization& lin, bool turning = true);

  const Model& model_;
  SolverSettings settings_;
  DofFilter filter_;
  PoolSpace space_;
  ModelData<PoolSpace> data_;
  PartSums<PoolSpace> node_parts_;
  CpuExecutor executor_;
  TangentSolver tangent_;
  Dependents<PoolSpace> dependents_;  ///< at the present state
  bool conservative_, linear_, extrapolates_;
  Followers<PoolSpace> followers_;
  Surfaces<PoolSpace> surfaces_;
  MotionSizes motions_;
  std::vector<double> masses_;  ///< part_masses()
  std::vector<char> driven_;    ///< driven_parts()

  State start_, state_;
  StepForm form_;
  StrainHistory history_;
  AlignedVector<double> start_strain_;  ///< E at the start of the step
  StressMemory<PoolSpace> memory_;
  AlignedVector<double> fading_;  ///< S_e at the end of a step
  MiddleStretches<std::vector<Vec3d>> middles_;
  std::vector<double> factors_;
  std::vector<double> reached_factors_;  ///< at the end of the last step
  Increment increment_, saved_;
  TakenStep taken_;
  bool has_taken_ = false;  ///< a step of Newton's method led to the present state

  std::vector<double> gradient_, load_, inertia_, direction_, dependent_forces_, work_;
  std::vector<double> node_energy_;  ///< as in ForceView
  std::vector<double> node_sums_;    ///< (parts × kNodeQuantities)
  std::vector<double> prescribed_;   ///< what is still to go, in constraint axes
  std::vector<PoseMotion> before_;   ///< motion in the step before
  std::vector<double> kept_loads_;   ///< by part, see keep_loads(); empty: none [N²]
  /// Where the last step of implicit Euler ended, and the energy there of what does not fade [J].
  struct Reached {
    std::vector<Vec3d> u;
    FrameMatrices D;
    double energy = 0;
  };
  std::optional<Reached> reached_;
  std::optional<Evaluation> known_;  ///< of the present state, where evaluate() would repeat itself
  InternalEnergy internal_;
  double load_energy_ = 0, inertia_energy_ = 0;
  double relative_ = 1;  ///< residual of the last evaluation, relative
  /// Work of loads without a potential along the steps of Newton's method, by the mean of their forces at the ends of
  /// each [J]; the length of a step whose end was not evaluated yet; where the direction starts, the loads' work along
  /// it and their potential [J].
  double load_work_ = 0, saved_work_ = 0, applied_ = 0, start_power_ = 0, start_potential_ = 0;
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

/// Fills factors at rest (all zero).
std::vector<double> zero_factors(const Model& model);

}  // namespace fascia
