#pragma once

#include "core/node/dof_filter.hpp"
#include "core/run/drivers.hpp"
#include "core/run/explicit_mode.hpp"
#include "core/run/explicit_nodes.hpp"
#include "core/run/explicit_plan.hpp"
#include "core/step/dependents.hpp"
#include "core/step/explicit_loops.hpp"
#include "core/step/model_data.hpp"
#include "core/step/moving_loads.hpp"
#include "core/step/stress_memory_steps.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace fascia {

/// Steps of central differences as a plan has them, in the memory of a space: one pass over points for the forces, one
/// over nodes. Nothing comes back to the host before it is asked for. What steps need is allocated once.
///
/// A step is written here once for all spaces. What derives from this evaluates forces and strains: an ExplicitStepper
/// on the processor, a gpu::ExplicitSystem on a device.
///
/// @tparam Own    that derives from this, and has the functions that explicit_steps_body.hpp calls by own()
/// @tparam Types  as of a StepSystem
template <class Own, class Types>
class ExplicitSteps {
 public:
  using Space = typename Types::Space;
  using Pose = typename Types::Pose;
  using Motions = decltype(Types::Memory::motion);
  using Progress = ExplicitProgress;

  ExplicitSteps(const ExplicitSteps&) = delete;
  ExplicitSteps& operator=(const ExplicitSteps&) = delete;

  const ExplicitPlan& plan() const { return plan_; }
  /// The next step of the plan.
  void advance();
  /// The stable step at the present state, without a margin [s]; after a step. Waits for the steps.
  double stable_step();
  /// Has the plan follow it.
  void adopt(double stable);
  /// Keeps all that steps change; returns to it, with steps that are no longer than a limit.
  void save();
  void restore(double limit);
  /// v and Q_dot of pose() at the present step, means of the half steps on both sides; accelerations of what is held,
  /// and Progress::motion.
  void report_velocities();

  /// Waits for the steps and says how they went.
  Progress progress() const;
  const Pose& pose() const { return pose_; }
  /// Accelerations of each constraint's node, at the last report_velocities().
  const Motions& held_accelerations() const { return held_acceleration_; }

  // ExplicitMode asks for these.
  Pose& pose() { return pose_; }
  const Space& space() const { return space_; }
  const Model& model() const { return model_; }
  int free_count() const { return filter_.free_count(); }
  /// The nodes at the present state.
  auto view() { return view(next_); }
  void keep_strain();
  void gather_acting(Pose& pose, double inverse_step, double* out);
  void place_dependents(Pose& pose) {
    if (!dependents_.empty()) dependents_.place(pose.u.data(), pose.D.data());
  }
  /// Calls act.operator()<Frames>().
  template <class Act>
  void for_nodes(const Act& act) {
    if (turning_)
      act.template operator()<true>();
    else
      act.template operator()<false>();
  }

 protected:
  using History = typename Types::History;

  /// @param state    with velocities, at the start
  /// @param factors  of all schedules at a time
  /// @throws InputError  where a node has no inertia
  ExplicitSteps(const Model& model, const State& state, const ExplicitPlan& plan, FactorFunction factors,
                Space space = Space());
  ~ExplicitSteps() = default;
  /// Finds the velocities half a step before the start, once forces can be evaluated.
  void begin();

  /// @param factors  at the state
  auto view(const Array<Space, double>& factors) { return own().with_blocks(nodes_view(factors)); }
  /// Gives points that remember stresses what they add at the state; empty where nothing fades.
  std::span<const double> given(double* memory);

  const Model& model_;
  FactorFunction factor_function_;
  ExplicitPlan plan_;
  DofFilter filter_;
  ExplicitNodes nodes_;
  Space space_;
  ModelData<Space> data_;
  Dependents<Space> dependents_;
  MovingLoads<Space> moving_;
  StressMemory<Space> memory_;
  bool turning_, damped_;
  Pose pose_;
  Array<Space, double> load_, gradient_;         ///< as in ExplicitView
  Array<Space, double> table_, present_, next_;  ///< factors: queued, at the present step, at the end of the next
  Array<Space, Progress> progress_;

 private:
  Own& own() { return static_cast<Own&>(*this); }
  ExplicitView nodes_view(const Array<Space, double>& factors);
  void show_nodes();
  void start_velocities();
  void queue_factors();
  /// Since the forces before: none at the start.
  Fading fading_to_here() const { return plan_.taken() == 0 ? Fading{} : Fading::over(last_step_); }
  void keep_memory(decltype(Pose::memory)& memory);
  void update_forces(const Array<Space, double>& factors);
  template <class View>
  void update_forces(const View& s, const Pose& pose, const History& history);
  void find_prescribed(const double* factors, Array<Space, double>& out);
  void step();
  /// Calls act(what changes, what is kept of it) for arrays of the space.
  template <class Act>
  void for_moving(const Act& act);

  /// Everything that steps change.
  struct Moving {
    Pose pose;
    Array<Space, Vec3d> half_v, half_spin;
    Array<Space, Mat3d> half_rate;
    Array<Space, double> last_increments, present, next;
    decltype(History::E) E;
    decltype(Pose::memory) memory;
    Array<Space, Progress> progress;
    std::optional<ExplicitPlan> plan;
    double last_step = 0;
  };

  double last_step_;  ///< [s]
  LeapTimes times_;   ///< about the present state
  int schedules_, queued_from_ = 0, queued_ = 0;
  std::uint64_t record_ = 0;  ///< changes with the times that a recorded step has in it

  Shown<Space, SpinInertia> turning_inertia_;
  Shown<Space, Vec3d> center_;
  Shown<Space, double> damping_, inverse_mass_;
  Shown<Space, int> affine_;
  Shown<Space, FrameInertia> uneven_;
  Shown<Space, char> follows_;
  ExplicitView constants_;                  ///< pointers to these
  Array<Space, Vec3d> half_v_, half_spin_;  ///< HalfStepVelocity at the last half step; the first alone of vertices
  Array<Space, Mat3d> half_rate_;
  Array<Space, double> increments_, last_increments_;  ///< prescribed, in constraint axes
  History history_;                                    ///< strains of the state before the present one
  History mode_history_;                               ///< strains of the state whose mode is looked for
  decltype(Pose::memory) before_;                      ///< what points remember from before the present state
  decltype(History::E) fading_;                        ///< what fades there
  bool acting_ = false;                                ///< forces are those of the present state, where they are kept
  Motions held_acceleration_;
  Moving saved_;
  std::unique_ptr<ExplicitMode<Own>> mode_;  ///< from the first stable_step() on
};

}  // namespace fascia
