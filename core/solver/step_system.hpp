#pragma once

#include "core/executor/block_executor.hpp"
#include "core/node/dof_filter.hpp"
#include "core/node/time_scheme.hpp"
#include "core/solver/boundary_motion.hpp"
#include "core/solver/part_forces.hpp"
#include "core/solver/settings.hpp"
#include "core/space/part_sums.hpp"
#include "core/step/dependents.hpp"
#include "core/step/model_data.hpp"
#include "core/step/moving_loads.hpp"
#include "core/step/step_view.hpp"
#include "core/step/stress_memory_steps.hpp"
#include "core/structure/model.hpp"

#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace fascia {

/// The equilibrium of a model in a load or time step, as Newton's method sees it: internal energy, loads, and in
/// dynamics the inertia of the step as a potential (incremental potential), in the form of time_scheme.hpp.
///
/// The unknown of a step is the motion since its start: u = u₀ + du, Q = (I + Ds) Q₀, A = A₀ + Ds. Velocities come from
/// du and Ds, never from a difference of positions, so that small steps keep their digits.
///
/// A step is written here once for all spaces. What derives from this sums forces and solves for directions: a
/// MechanicalSystem on the processor, a gpu::System on a device.
///
/// @tparam Own    that derives from this, and has the functions that step_system_body.hpp calls by own()
/// @tparam Types  Space; Pose and Memory, as State and StepMemory have their members; History, likewise StrainHistory;
///                Vector, of numbers; Mark, of the end of a step, as EndMark
template <class Own, class Types>
class StepSystem {
 public:
  using Space = typename Types::Space;
  using Pose = typename Types::Pose;
  using Memory = typename Types::Memory;
  using Motions = decltype(Memory::motion);  ///< PoseMotion, of nodes or constraints

  StepSystem(const StepSystem&) = delete;
  StepSystem& operator=(const StepSystem&) = delete;

  /// Starts a step of implicit Euler from `start`. @param dt  0: statics
  void begin_step(const Pose& start, double dt) { begin_step(start, dt, TimeScheme::implicit_euler, {}); }
  /// Starts a step of a scheme. @param memory  of the step before, as far as the scheme needs it
  void begin_step(const Pose& start, double dt, TimeScheme scheme, const Memory& memory);
  /// Loads and boundary motions where the step's equations hold (midpoint: in its middle, else at its end): one factor
  /// for each schedule.
  void set_factors(std::span<const double> factors);
  /// Loads and boundary motions of the model at rest: none, wherever drivers start their motions.
  void set_rest();
  /// Starts Newton where the old velocities lead, if the step's potential is lower there than at the old state.
  void start_from_prediction();
  /// Reads anew the motions that a driver gives, which start at their factor 0. Before the step's factors are set.
  void restart_motions();
  /// Goes on from a state as if it had been given it, but for what linear solvers have learned: what comes next depends
  /// on that state, the memory of its step, and what is said here alone.
  /// @param factors    of schedules at that state
  /// @param pressures  reached_pressures() there; empty: none
  void forget_steps(std::span<const double> factors, const std::vector<double>& pressures);

  /// The state at the end of the step, with its velocities. Of a midpoint step the factors must be set to those of the
  /// end before; what is prescribed then is on its target.
  /// @param end  takes it in place: it keeps its memory from step to step
  void finish_step(double end_time, Memory& memory, Pose& end);
  void finish_step(double end_time, Pose& end) {
    Memory unused;
    finish_step(end_time, unused, end);
  }
  /// Accelerations from the equation of motion at a state (Newmark's start), zero where a node has no inertia and in
  /// what is prescribed. The factors must be set to those of its time. @param dt  of the step to come
  void start_acceleration(const Pose& start, double dt, Memory& memory);

  // Evaluations of states that no step's equations hold at. The gradient is what acts there: with the viscous stress
  // and the mass damping of what is held, without inertia. Energies are those of the state at rest.
  /// The strain rate comes from strains along the velocities, a time h ahead and behind. @param h  0: no viscous stress
  void look_at(const Pose& state, double h);
  /// After a midpoint step: the state at its end, with what accelerated supports carry. The strain rate comes from the
  /// strains of three states, since velocities of the midpoint rule ring where strong damping starts at once; tethers
  /// pull as in the middles of the last two steps, since stiff ones ring too.
  /// @param before   the state at its start
  /// @param earlier  the one as long before that, or empty: the strain rate is then that of the middle of the step
  void look_back(const Pose& state, const Pose& before, const Pose& earlier, double dt);
  /// Adds to the gradient what accelerated supports carry of their own mass, which a state at rest does not show.
  /// @param acceleration  of each constraint: of its node's origin and Q or A
  void add_held_inertia(const Motions& acceleration);

  // Newton asks for these; the direction, which leads on, is the derived class's.
  Evaluation evaluate() { return known_ ? *std::exchange(known_, std::nullopt) : own().evaluate_anew(); }
  void apply(double step);
  void save();
  void restore();
  bool conservative() const { return conservative_; }

  /// The step's equations hold in its middle: after finish_step() the gradient is not that of the end.
  bool solves_for_middle() const { return step_.scheme == TimeScheme::midpoint; }

  const Model& model() const { return model_; }
  const SolverSettings& settings() const { return settings_; }
  const DofFilter& filter() const { return filter_; }
  /// Where loops over nodes run, and the view that they have, with the factors set last.
  const Space& space() const { return space_; }
  const ModelView& nodes() const { return data_.view(); }
  std::span<const double> factors() const { return factors_; }
  /// Factors of schedules at the end of the last step.
  const std::vector<double>& reached_factors() const { return reached_factors_; }
  /// Newton's pressures of enclosed volumes at the end of the last step [Pa].
  std::vector<double> reached_pressures() const {
    return moving_.surfaces.empty() ? std::vector<double>{} : moving_.surfaces.reached();
  }
  /// At the last evaluation.
  InternalEnergy internal_energy() const { return internal_; }

 protected:
  using Strains = decltype(Memory::E);
  using Vector = typename Types::Vector;

  StepSystem(const Model& model, const SolverSettings& settings, Space space = Space());
  ~StepSystem() = default;

  StepView step_view();
  ForceView force_view() { return {gradient_.data(), load_.data(), inertia_.data(), node_energy_.data()}; }
  PoseView pose() const { return {now_.u.data(), now_.D.data()}; }
  /// Places the nodes by their increments.
  void rebuild_state();
  /// Gives the points that remember stresses, or make them, what they add to a step, or to a state that was reached.
  void give_memory(const Fading& fading);
  /// Gives it anew once a step has begun. @param factors  of schedules that came after that, in the space
  void act(const double* factors);
  /// Judges the forces of all parts, with the energies of the last evaluation.
  Evaluation judged(std::span<const PartForces> parts) const;

  const Model& model_;
  SolverSettings settings_;
  DofFilter filter_;
  Space space_;
  ModelData<Space> data_;
  PartSums<Space> node_parts_;
  Dependents<Space> dependents_;  ///< at the present state
  MovingLoads<Space> moving_;     ///< at the state of the last evaluation
  StressMemory<Space> memory_;
  bool conservative_, turning_, damped_;
  MotionSizes motions_;
  std::vector<double> masses_;  ///< part_masses()
  std::vector<char> driven_;    ///< driven_parts()

  Pose start_;
  StepConstants step_;
  Motions q_, w_;           ///< as in StepView
  Pose increment_, saved_;  ///< since the start, in u, D and turned
  Pose now_;
  typename Types::History history_;
  std::vector<double> factors_, reached_factors_;
  MiddleStretches<decltype(Pose::u)> middles_;

  Vector gradient_, load_, inertia_, node_energy_, dependent_forces_;  ///< as in ForceView; (dependents × 6)
  Vector direction_;                                                   ///< by degrees of freedom in world axes
  std::optional<Evaluation> known_;  ///< of the present state, where evaluate() would repeat itself
  InternalEnergy internal_;
  double load_energy_ = 0, inertia_energy_ = 0;
  /// Work of loads without a potential along the steps of Newton's method [J], of who counts it.
  double load_work_ = 0;
  bool factors_are_placed_ = false;  ///< the space has them, and tethers pull where they say

 private:
  Own& own() { return static_cast<Own&>(*this); }
  void place_dependents();
  double energy_at_start();
  void predict_strain(const Memory& memory);
  void store_strain_along_velocity(double time);
  void store_strain_at(const Pose& pose, Strains& E);
  void follow_strain(const Pose& before, const Pose& earlier, double dt);
  void keep_memory(Pose& state);
  void note_stretches();
  void add_support_inertia(const Pose& before, double inverse_dt);
  /// Runs a loop over the strains of a history.
  template <class Loop>
  void for_strains(const Loop& loop) {
    space_.for_each(static_cast<int>(history_.E.size()), loop);
  }

  Pose moved_;  ///< where something is looked at beside the step
  Strains start_E_, ahead_E_, behind_E_;
  Strains fading_;  ///< S_e at the end of a step
  Motions before_;  ///< motion in the step before
  /// Where the last step of implicit Euler ended, and the energy there of what does not fade [J].
  typename Types::Mark end_;
  double end_energy_ = 0;
};

}  // namespace fascia
