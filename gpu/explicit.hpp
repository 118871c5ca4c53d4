#pragma once

#include "core/solver/drivers.hpp"
#include "core/solver/explicit_nodes.hpp"
#include "gpu/blocks.hpp"
#include "gpu/dependents.hpp"
#include "gpu/device_state.hpp"
#include "gpu/explicit_kernels.hpp"
#include "gpu/followers.hpp"
#include "gpu/model_data.hpp"
#include "gpu/surfaces.hpp"

#include <vector>

namespace fascia::gpu {

/// Steps of central differences with everything in the memory of a space: the counterpart of ExplicitStepper. Steps
/// are queued one after the other, and nothing comes back before it is asked for.
template <class Space>
class ExplicitSystem {
 public:
  using Progress = kernels::ExplicitProgress;

  /// @param state    with velocities, at the start
  /// @param factors  of all schedules at a time
  /// @throws InputError  where a node has no inertia
  ExplicitSystem(const Model& model, const State& state, double dt, FactorFunction factors);

  /// One step.
  void advance();
  /// v and Q_dot of pose() at the present step, accelerations of what is held, and Progress::motion.
  void report_velocities();

  /// Waits for the steps and says how they went.
  Progress progress() const { return progress_.downloaded()[0]; }
  const DeviceState<Space>& pose() const { return pose_; }
  /// At the present step, without viscous stress.
  InternalEnergy energy();
  /// Of each constrained node, at the last report_velocities().
  std::vector<PoseMotion> held_accelerations() const { return held_acceleration_.downloaded(); }
  int constraint_of(int node) const { return nodes_.constraint[at(node)]; }
  double time() const { return time_of(steps_); }
  double time_step() const { return dt_; }

 private:
  template <class Act>
  void for_nodes(const Act& act);
  kernels::ExplicitView view(const Array<Space, double>& factors);
  PoseView pose_view() const { return {pose_.u.data(), pose_.D.data()}; }
  double time_of(int step) const { return begin_ + step * dt_; }
  void upload_nodes();
  void start_velocities();
  void store_start_strain();
  void place_tethers();
  void queue_factors();
  void update_forces(const Array<Space, double>& factors);
  void find_prescribed(const double* factors, Array<Space, double>& out);
  void step();

  static constexpr int kQueue = 128;  ///< steps whose factors are uploaded together

  const Model& model_;
  FactorFunction factor_function_;
  double dt_, begin_;
  DofFilter filter_;
  ExplicitNodes nodes_;
  ModelData<Space> data_;
  Blocks<Space> blocks_;
  Dependents<Space> dependents_;
  Followers<Space> followers_;
  Surfaces<Space> surfaces_;
  typename Space::Loop loop_;
  DeviceState<Space> pose_;
  int schedules_, steps_ = 0, queued_from_ = 0, queued_ = 0;

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
  Array<Space, double> table_, present_, next_;  ///< factors: queued, at the present step, at the end of the next
  Array<Space, double> still_, energies_;
  Array<Space, PoseMotion> held_acceleration_;
  Array<Space, Progress> progress_;
};

}  // namespace fascia::gpu
