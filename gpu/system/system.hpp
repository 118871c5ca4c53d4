#pragma once

#include "core/levels/blocks_or_levels.hpp"
#include "core/levels/kept_levels.hpp"
#include "core/run/drivers.hpp"
#include "core/solver/boundary_motion.hpp"
#include "core/space/part_sums.hpp"
#include "core/step/dependents.hpp"
#include "core/step/followers.hpp"
#include "core/step/model_data.hpp"
#include "core/step/stress_memory_steps.hpp"
#include "core/step/surfaces.hpp"
#include "gpu/blocks/blocks.hpp"
#include "gpu/system/cg.hpp"
#include "gpu/system/device_state.hpp"
#include "gpu/system/host_system.hpp"
#include "gpu/system/levels.hpp"
#include "gpu/system/operator_kernels.hpp"
#include "gpu/system/step_kernels.hpp"
#include "gpu/tiles/tile_solver.hpp"

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fascia::gpu {

/// The equilibrium of a model in a load or time step with everything in the memory of a space: the counterpart of
/// MechanicalSystem, which says what the functions mean. Only a few numbers of each evaluation and solve come back.
template <class Space>
class System {
 public:
  /// Unknowns of a model that the host factorises in seconds at most.
  static constexpr int kMostOfFactor = 15000;

  using Pose = DeviceState<Space>;
  using Memory = DeviceMemory<Space>;

  /// Direct solves are those of conjugate gradients here, and a Cholesky preconditioner is block-Jacobi. Levels of
  /// rigid frames are made by the host; where precision is single there are none.
  System(const Model& model, const SolverSettings& settings);

  void begin_step(const Pose& start, double dt) { begin_step(start, dt, TimeScheme::implicit_euler, {}); }
  void begin_step(const Pose& start, double dt, TimeScheme scheme, const Memory& memory);
  void set_factors(std::span<const double> factors);
  void set_rest();
  void start_from_prediction();
  void restart_motions();
  void begin_afresh(std::span<const double> factors, const std::vector<double>& pressures);
  void forget_steps(std::span<const double> factors, const std::vector<double>& pressures);
  const std::vector<double>& reached_factors() const { return reached_factors_; }
  std::vector<double> reached_pressures() const {
    return surfaces_.empty() ? std::vector<double>{} : surfaces_.reached();
  }
  void finish_step(double end_time, Memory& memory, Pose& end);
  void finish_step(double end_time, Pose& end) {
    Memory unused;
    finish_step(end_time, unused, end);
  }
  void start_acceleration(const Pose& start, double dt, Memory& memory);
  void look_at(const Pose& state, double h);
  /// Adds what supports carry of their own mass, see MechanicalSystem.
  void add_held_inertia(const Array<Space, PoseMotion>& acceleration);
  void look_back(const Pose& state, const Pose& before, const Pose& earlier, double dt);

  Evaluation evaluate();
  /// @param most_iterations  of conjugate gradients, where the settings allow as many
  DirectionReport direction(int most_iterations = kAsManyAsNeeded);
  static double largest_step(double wanted) { return wanted; }  // user blocks are not here
  void apply(double step);
  void save();
  void restore();
  bool has_prescribed_increment() const { return prescribed_left_; }
  bool conservative() const { return conservative_; }
  bool compares_energies() const { return conservative_; }
  double prescribed_rotation();
  bool solves_for_middle() const { return step_.scheme == TimeScheme::midpoint; }

  const Model& model() const { return model_; }
  const SolverSettings& settings() const { return settings_; }
  const DofFilter& filter() const { return filter_; }
  std::span<const double> factors() const { return factors_; }
  /// The present one, of Newton's method; its velocities are those of the step's start.
  State state() const;
  InternalEnergy internal_energy() const { return internal_; }
  /// By degrees of freedom, as MechanicalSystem::gradient().
  std::vector<double> gradient() const { return gradient_.downloaded(); }
  /// Forces on dependent nodes, as MechanicalSystem::dependent_forces().
  std::vector<double> dependent_forces() const { return dependent_forces_.downloaded(); }
  /// Reads what acts at the last evaluation, but for tether_forces.
  void read(const ReachedParts& parts, ReachedForces& out);
  /// Targets of tethers, as CpuExecutor::targets(); empty where nothing is tethered.
  std::vector<double> tether_targets();
  /// K d at the last evaluation, by degrees of freedom in world axes.
  std::vector<double> product(std::span<const double> d);
  /// A system of the host with Cholesky's factors, made when it is first asked for.
  MechanicalSystem& host();
  /// Stability of an equilibrium, as MechanicalSystem::stability(), by conjugate gradients.
  Stability stability(const Pose& end) {
    return stability_of(*this, end, Pose(State::at_rest(model_)), [&](bool) { return softest(); });
  }

 private:
  /// Times the usual limit of conjugate gradients that a slender body may take.
  static constexpr int kPatience = 20;
  BlocksOrLevels::Costs costs_of_levels() const;

  StepView step_view();
  ForceView force_view();
  /// Calls act.operator()<T, V>() with the scalars of products and of the vectors of solves.
  template <class Act>
  decltype(auto) with_scalars(const Act& act) {
    if (settings_.precision == Precision::single) return act.template operator()<float, float>();
    if (settings_.precision == Precision::mixed) return act.template operator()<float, double>();
    return act.template operator()<double, double>();
  }
  template <class T, class V>
  kernels::ProductView<T, V> product_view();
  HistoryView history() const {
    return {.E = damped_ ? E_.data() : nullptr, .inverse_step = damped_ ? inverse_step_ : 0.0, .given = given_};
  }
  PoseView pose() const { return {u_.data(), D_.data()}; }
  void rebuild_state();
  void place_dependents();
  void evaluate_forces(bool quantities = true);
  void evaluate_loads();
  void add_other_loads();
  /// The surfaces' figures in the report.
  std::span<const double> figures() const {
    return std::span(report_values_)
        .subspan(report_values_.size() - 3 - surfaces_.figure_count(), surfaces_.figure_count());
  }
  Evaluation judge();
  double energy_at_start();
  void predict_strain(const Memory& memory);
  void give_memory(const Fading& fading);
  void keep_memory(Pose& state);
  void store_strain_along_velocity(double h);
  void follow_strain(const Pose& before, const Pose& earlier, double dt);
  void note_stretches();
  void stretch_tethers(double time);
  void store_strain_at(const Pose& pose, Array<Space, double>& E);
  void find_prescribed();
  void linearize(Tangent tangent, bool tethers_turn, const TakenStepView& taken = {});
  TakenStepView taken_step() const;
  void linearize_tiles(Tangent tangent);
  const Mat3d* linearize_blocks(Tangent tangent, const TakenStepView& taken);
  double note_direction();
  template <class T, class V>
  void apply_tangent(const CgView<V>& v);
  template <class T, class V>
  void multiply(const kernels::ProductView<T, V>& w);
  template <class T, class V>
  void gather_product(const kernels::ProductView<T, V>& w);
  std::string not_in_tiles() const;
  /// @throws NotShared
  void make_tiles();
  /// Tiles compute the tangent of this step. They know the strains at the start of a step, and no others.
  /// Levels take their place: a fallback from levels finds no other tangent than theirs.
  bool use_tiles() const {
    return tiles_ != nullptr && !blocks_or_levels_.levels() &&
           (inverse_step_ == 0 || !damped_ || step_.scheme == TimeScheme::implicit_euler);
  }
  std::uint64_t operator_key();
  template <class V>
  auto& solver() {
    if constexpr (std::is_same_v<V, double>)
      return cg_;
    else
      return narrow_cg_;
  }
  bool use_levels() const {
    const bool asked = settings_.preconditioner == PreconditionerKind::multigrid;
    return levels_fit_ && (asked || (blocks_or_levels_.levels() && !kept_levels_.fail()));
  }
  CgReport solve(const CgOptions& options, bool has_material = true);
  CgReport solve_by_blocks(const CgOptions& options);
  CgReport solve_by_levels(const CgOptions& options, bool has_material);
  bool make_levels(bool material);
  bool levels_may_pay() const;
  CgOptions before_levels() const;
  bool limit_is_guessed() const {
    return settings_.linear == LinearMethod::automatic && settings_.cg.max_iterations == CgOptions{}.max_iterations;
  }
  CgOptions solve_options() const;
  bool host_may_solve() const;
  bool host_is_faster(int iterations);
  StepInProgress step_in_progress() const;
  /// That the viscous stress of the last evaluation comes from.
  StrainHistory strain_history() const;
  bool unsymmetric() const;
  std::optional<CgReport> solve_unsymmetric(const CgOptions& asked);
  void product_at_rest(double* p);
  DirectionReport direction_of_host();
  SoftestDirection softest();
  CgReport solve_in_tiles(const CgOptions& options);
  void place_tethers();

  const Model& model_;
  SolverSettings settings_;
  DofFilter filter_;
  ModelData<Space> data_;
  Blocks<Space> blocks_;
  Dependents<Space> dependents_;
  Followers<Space> followers_;
  Surfaces<Space> surfaces_;
  SurfaceTangent<Space> surface_tangent_;
  PartSums<Space> node_parts_;
  ConjugateGradients<Space, double> cg_;
  ConjugateGradients<Space, float> narrow_cg_;
  std::vector<std::uint8_t> held_;     ///< degrees of freedom that tiles hold, by node
  std::unique_ptr<TileSolver> tiles_;  ///< of meshless solids alone; none where they cannot hold them
  bool conservative_, extrapolates_, turning_, damped_;
  MotionSizes motions_;
  std::vector<double> masses_;  ///< part_masses()
  std::vector<char> driven_;    ///< driven_parts()

  Pose start_;
  StepConstants step_;
  double inverse_step_ = 0;  ///< of the viscous stress
  Array<Space, double> E_, start_E_, ahead_E_, behind_E_;
  StressMemory<Space> memory_;
  Array<Space, double> fading_;    ///< what fades at the end of a step
  const double* given_ = nullptr;  ///< by memory_; null where nothing fades
  Array<Space, Vec3d> du_, saved_du_, u_, moved_u_;
  Array<Space, Mat3d> Ds_, saved_Ds_, D_, moved_D_;
  Array<Space, double> turned_, saved_turned_;
  Array<Space, Vec3d> taken_u_;  ///< where the last step of Newton's method started
  Array<Space, Mat3d> taken_D_;
  double taken_length_ = 0;  ///< 0: none led to the present state
  Array<Space, PoseMotion> q_, w_;
  Array<Space, PoseMotion> before_;  ///< motion in the step before
  Array<Space, Tether> tethers_;
  MiddleStretches<Array<Space, Vec3d>> middles_;
  std::vector<double> factors_, reached_factors_;
  bool factors_are_placed_ = false;

  Array<Space, double> gradient_, load_, inertia_, node_energy_, report_, part_motion_, start_motion_;
  Array<Space, double> dependent_forces_;
  Array<Space, Mat3d> L_, tether_L_, extrapolated_L_;
  Array<Space, double> prescribed_;  ///< what is still to go, in constraint axes
  std::vector<double> report_values_;

  Array<Space, Mat3d> Q_, dA_;
  Array<Space, Vec3d> dx_;
  Array<Space, double> node_blocks_, inverse_, world_d_, world_y_, direction_, asked_, still_, still_Ap_, slope_, spin_;
  Array<Space, float> narrow_blocks_, narrow_inverse_, narrow_d_;
  Array<Space, Vec3<float>> narrow_dx_;
  Array<Space, Mat3<float>> narrow_dA_;
  Array<Space, CgProgress> idle_;
  Tangent tangent_ = Tangent::full;
  /// All that the loops of a product are recorded with.
  struct Operator {
    double inverse_step = 0;
    Tangent tangent = Tangent::full;
    bool extrapolated = false;
    std::uint64_t levels = 0;
    bool operator==(const Operator&) const = default;
  } operator_;
  std::uint64_t operator_count_ = 0;  ///< operators that differed from the one before

  std::optional<Evaluation> known_;
  std::optional<std::pair<long, double>> reached_;  ///< a state reached, and the energy of what does not fade
  InternalEnergy internal_;
  double load_energy_ = 0, inertia_energy_ = 0;
  bool prescribed_left_ = false;
  long steps_ = 0;
  int most_iterations_ = kAsManyAsNeeded;  ///< of conjugate gradients in a direction

  /// It solves where conjugate gradients meet an indefinite tangent, or take longer than it does.
  std::unique_ptr<HostSystem> host_;
  bool indefinite_ = false;  ///< the last direction was the host's, and its tangent indefinite
  bool too_slow_ = false;    ///< conjugate gradients took so long that the host solves from there on
  Levels<Space> levels_;
  KeptLevels kept_levels_;
  Array<Space, double> kept_rhs_;                       ///< of solves that may begin again
  BlocksOrLevels blocks_or_levels_{costs_of_levels()};  ///< of an automatic preconditioner
  bool levels_fit_ = true;                              ///< into memory
};

}  // namespace fascia::gpu
