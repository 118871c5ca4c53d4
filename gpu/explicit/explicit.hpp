#pragma once

#include "core/run/drivers.hpp"
#include "core/run/explicit_mode.hpp"
#include "core/run/explicit_nodes.hpp"
#include "core/run/explicit_plan.hpp"
#include "core/step/dependents.hpp"
#include "core/step/followers.hpp"
#include "core/step/model_data.hpp"
#include "core/step/stress_memory_steps.hpp"
#include "core/step/surfaces.hpp"
#include "gpu/blocks/blocks.hpp"
#include "gpu/explicit/explicit_kernels.hpp"
#include "gpu/system/device_state.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace fascia::gpu {

/// Steps of central differences with everything in the memory of a space: the counterpart of ExplicitStepper. Steps
/// are queued one after the other, and nothing comes back before it is asked for.
template <class MemorySpace>
class ExplicitSystem {
 public:
  using Space = MemorySpace;
  using Pose = DeviceState<Space>;
  using Progress = kernels::ExplicitProgress;

  /// @param state    with velocities, at the start
  /// @param plan     of the steps
  /// @param factors  of all schedules at a time
  /// @throws InputError  where a node has no inertia
  ExplicitSystem(const Model& model, const State& state, const ExplicitPlan& plan, FactorFunction factors);

  const ExplicitPlan& plan() const { return plan_; }
  /// The next step of the plan.
  void advance();
  /// The stable step at the present state, without a margin [s]; waits for the steps.
  double stable_step();
  /// Has the plan follow it.
  void adopt(double stable);
  /// Keeps all that steps change; returns to it, with steps that are no longer than a limit.
  void save();
  void restore(double limit);
  /// v and Q_dot of pose() at the present step, accelerations of what is held, and Progress::motion.
  void report_velocities();

  /// Waits for the steps and says how they went.
  Progress progress() const { return progress_.downloaded()[0]; }
  const Pose& pose() const { return pose_; }
  Pose& pose() { return pose_; }
  /// At the present step, without viscous stress.
  InternalEnergy energy() { return energy(true); }
  /// Accelerations of each constraint's node, at the last report_velocities().
  const Array<Space, PoseMotion>& held_accelerations() const { return held_acceleration_; }

  // ExplicitMode asks for these.
  Space space() const { return {}; }
  const Model& model() const { return model_; }
  int free_count() const { return filter_.free_count(); }
  /// The nodes at the present state.
  kernels::ExplicitBlocksView view() { return view(next_); }
  void keep_strain();
  void gather_acting(Pose& pose, double inverse_step, double* out);
  void place_dependents(Pose& pose) {
    if (!dependents_.empty()) dependents_.place(pose.u.data(), pose.D.data());
  }
  /// Calls act.operator()<Frames>().
  template <class Act>
  void for_nodes(const Act& act);

 private:
  using View = kernels::ExplicitBlocksView;

  /// Everything that steps change.
  struct Moving {
    Pose pose;
    Array<Space, Vec3d> half_v, half_spin;
    Array<Space, Mat3d> half_rate;
    Array<Space, double> last_increments, E, memory, present, next, targets;
    Array<Space, Progress> progress;
    std::optional<ExplicitPlan> plan;
    double last_step = 0;
  };
  /// Calls act(what changes, what is kept of it).
  template <class Act>
  void for_moving(const Act& act);
  kernels::ExplicitBlocksView view(const Array<Space, double>& factors);
  PoseView pose_view() const { return {pose_.u.data(), pose_.D.data()}; }
  void upload_nodes();
  void start_velocities();
  void store_start_strain();
  void place_tethers();
  const double* give_memory(Array<Space, double>& memory);
  /// Since the forces before: none at the start.
  Fading fading_to_here() const { return plan_.taken() == 0 ? Fading{} : Fading::over(last_step_); }
  InternalEnergy energy(bool faded);
  void keep_memory(Array<Space, double>& memory);
  void queue_factors();
  void update_forces(const Array<Space, double>& factors);
  void update_forces(const kernels::ExplicitBlocksView& s, const HistoryView& history);
  void find_prescribed(const double* factors, Array<Space, double>& out);
  void step();

  static constexpr int kQueue = 128;  ///< steps whose factors are uploaded together

  const Model& model_;
  FactorFunction factor_function_;
  ExplicitPlan plan_;
  double last_step_;  ///< [s]
  LeapTimes times_;   ///< about the present state
  DofFilter filter_;
  ExplicitNodes nodes_;
  ModelData<Space> data_;
  Blocks<Space> blocks_;
  Dependents<Space> dependents_;
  Followers<Space> followers_;
  Surfaces<Space> surfaces_;
  typename Space::Loop loop_;
  Pose pose_;
  int schedules_, queued_from_ = 0, queued_ = 0;
  std::uint64_t record_ = 0;  ///< changes with the times that a recorded step has in it

  Array<Space, SpinInertia> turning_;
  Array<Space, Vec3d> center_;
  Array<Space, double> damping_, inverse_mass_;
  Array<Space, int> affine_;
  Array<Space, FrameInertia> uneven_;
  Array<Space, char> follows_;
  Array<Space, Tether> tethers_;
  Array<Space, Vec3d> half_v_, half_spin_;
  Array<Space, Mat3d> half_rate_;
  Array<Space, double> load_, gradient_, increments_, last_increments_, E_;
  StressMemory<Space> memory_;
  Array<Space, double> before_;                  ///< what points remember from before the present state
  Array<Space, double> fading_;                  ///< what fades there
  Array<Space, double> mode_E_;                  ///< of the state whose mode is looked for
  Array<Space, double> table_, present_, next_;  ///< factors: queued, at the present step, at the end of the next
  Array<Space, double> still_, energies_;
  Array<Space, PoseMotion> held_acceleration_;
  Array<Space, Progress> progress_;
  Moving saved_;
  std::unique_ptr<ExplicitMode<ExplicitSystem>> mode_;  ///< of automatic steps
};

}  // namespace fascia::gpu
