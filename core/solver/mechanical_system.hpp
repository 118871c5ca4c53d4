#pragma once

#include "core/cpu/executor.hpp"
#include "core/model/model.hpp"
#include "core/solver/newton.hpp"
#include "core/solver/tangent_solver.hpp"

#include <span>
#include <vector>

namespace fascia {

/// The equilibrium of a model at the end of a load or time step, as Newton's method sees it: internal energy, loads,
/// and in dynamics the inertia of an implicit Euler step as a potential (incremental potential).
///
/// The unknown of a step is the motion since its start: u = u₀ + du, Q = (I + Ds) Q₀, A = A₀ + Ds. Velocities come from
/// du and Ds, never from a difference of positions, so that small steps keep their digits.
class MechanicalSystem {
 public:
  MechanicalSystem(const Model& model, ThreadPool& pool, const SolverSettings& settings);

  /// Starts a step from `start`. @param dt  0: statics
  void begin_step(const State& start, double dt);
  /// Loads and boundary motions at the end of the step: one factor for each schedule.
  void set_factors(std::span<const double> factors);
  /// Starts Newton where the old velocities lead, if the step's potential is lower there than at the old state.
  void start_from_prediction();
  /// The state reached, with the velocities of the step.
  State finish_step(double end_time);

  // What Newton asks for.
  Evaluation evaluate();
  DirectionReport direction();
  void apply(double step);
  void save();
  void restore();
  bool has_prescribed_increment() const;
  bool conservative() const { return conservative_; }

  /// Largest rotation [rad] by which a boundary motion would turn a frame from its present place.
  double prescribed_rotation() const;

  const State& state() const { return state_; }
  /// Gradient of the internal energy, loads and inertia: what supports add to hold the model (by degrees of freedom).
  std::span<const double> gradient() const { return gradient_; }
  InternalEnergy internal_energy() const { return internal_; }
  double load_energy() const { return load_energy_; }  ///< potential of the conservative dead loads [J]
  const CpuExecutor& executor() const { return executor_; }
  const Model& model() const { return model_; }
  const DofFilter& filter() const { return filter_; }
  TangentSolver& tangent() { return tangent_; }

 private:
  /// What a step changes, for save() and restore().
  struct Increment {
    std::vector<Vec3d> du;
    std::vector<Mat3d> Ds;
    std::vector<std::array<double, 3>> turned;  ///< as in State
  };
  void rebuild_state();
  void add_loads();
  void add_inertia();
  void add_squares(std::span<const double> global, std::vector<double>& free, std::vector<double>& fixed);
  void add(std::vector<double>& out, int node, const Vec3d& force, const Mat3d& N, const Vec3d& torque) const;
  bool rigid(std::size_t node) const { return model_.frame_kind[node] == FrameKind::rigid; }
  Mat3d motion_of(std::size_t node) const;  ///< of Q or A since the start of the step
  Vec3d displacement(int motion, const Vec3d& X) const;
  double rotation_in(int node, const double* vector) const;
  double largest_angle() const;
  void prescribe_affine(const FrameConstraint& constraint, double* local) const;
  void prescribed_increments(std::span<double> local) const;
  void add_node_blocks(Linearization& lin) const;

  const Model& model_;
  SolverSettings settings_;
  DofFilter filter_;
  CpuExecutor executor_;
  TangentSolver tangent_;
  bool conservative_;

  State start_, state_;
  double dt_ = 0;
  StrainHistory history_;
  std::vector<double> factors_;
  std::vector<double> reached_factors_;  ///< at the end of the last step
  Increment increment_, saved_;

  std::vector<double> gradient_, load_, inertia_, direction_;
  mutable std::vector<double> work_;
  std::vector<double> inertia_rounding_;  ///< by part [N]
  struct PartSquares {
    std::vector<double> load, held_load, inertia, residual, reaction, unused;
  } part_squares_;
  InternalEnergy internal_;
  double load_energy_ = 0, inertia_energy_ = 0;
  Linearization lin_;
};

/// Fills factors at rest (all zero).
std::vector<double> zero_factors(const Model& model);

}  // namespace fascia
