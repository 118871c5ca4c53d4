#pragma once

#include "core/levels/blocks_or_levels.hpp"
#include "core/levels/kept_levels.hpp"
#include "core/run/drivers.hpp"
#include "core/solver/step_system.hpp"
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

/// A step with everything in the memory of a space: forces by its blocks, directions by conjugate gradients there. Only
/// a few numbers of each evaluation and solve come back.
template <class Space>
class System : public StepSystem<System<Space>, DeviceStep<Space>> {
  using Base = StepSystem<System<Space>, DeviceStep<Space>>;

 public:
  /// Unknowns of a model that the host factorises in seconds at most.
  static constexpr int kMostOfFactor = 15000;

  using typename Base::Memory;
  using typename Base::Pose;

  /// Direct solves are those of conjugate gradients here, and a Cholesky preconditioner is block-Jacobi. Levels of
  /// rigid frames are made by the host; where precision is single there are none.
  System(const Model& model, const SolverSettings& settings);

  /// StepSystem forgets its steps, and linear solvers forget what they have learned.
  void begin_afresh(std::span<const double> factors, const std::vector<double>& pressures);

  /// @param most_iterations  of conjugate gradients, where the settings allow as many
  DirectionReport direction(int most_iterations = kAsManyAsNeeded);
  static double largest_step(double wanted) { return wanted; }  // user blocks are not here
  bool has_prescribed_increment() const { return prescribed_left_; }
  bool compares_energies() const { return conservative_; }
  double prescribed_rotation();

  /// The present one, of Newton's method; its velocities are those of the step's start.
  State state() const;
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
  friend Base;
  using Base::conservative_, Base::damped_, Base::data_, Base::dependent_forces_, Base::dependents_, Base::direction_,
      Base::driven_, Base::factors_, Base::filter_, Base::gradient_, Base::history_, Base::increment_, Base::inertia_,
      Base::inertia_energy_, Base::internal_, Base::load_, Base::load_energy_, Base::masses_, Base::memory_,
      Base::middles_, Base::model_, Base::motions_, Base::node_parts_, Base::now_, Base::q_, Base::reached_factors_,
      Base::settings_, Base::start_, Base::step_, Base::moving_, Base::turning_, Base::w_;
  using Base::force_view, Base::pose, Base::step_view;

  // StepSystem calls these.
  void step_began();
  void place_tethers();
  void release_tethers();
  void store_strain(const Pose& state, Array<Space, double>& E);
  void store_stress(const Pose& state, std::span<const double> given, Array<Space, double>& out) {
    blocks_.store_stress({state.u.data(), state.D.data()}, given.data(), out.data());
  }
  void store_stretches(Vec3d* stretch);
  void stretch_tethers(const std::array<double, 3>& weights);
  Evaluation evaluate_anew();
  void evaluate_unjudged() { evaluate_forces(); }
  void evaluate_loads();
  double* scratch() { return world_y_.data(); }
  void note_step(double step);
  void step_saved() {}
  void step_restored() { taken_length_ = 0; }

  /// Times the usual limit of conjugate gradients that a slender body may take.
  static constexpr int kPatience = 20;
  BlocksOrLevels::Costs costs_of_levels() const;

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
    return {.E = damped_ ? history_.E.data() : nullptr,
            .inverse_step = damped_ ? history_.inverse_step : 0.0,
            .given = history_.given.data()};
  }
  void evaluate_forces(bool quantities = true);
  void add_other_loads();
  /// The surfaces' figures in the report.
  std::span<const double> figures() const {
    return std::span(report_values_)
        .subspan(report_values_.size() - 3 - moving_.surfaces.figure_count(), moving_.surfaces.figure_count());
  }
  Evaluation judge();
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
           (history_.inverse_step == 0 || !damped_ || step_.scheme == TimeScheme::implicit_euler);
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

  Blocks<Space> blocks_;
  SurfaceTangent<Space> surface_tangent_;
  ConjugateGradients<Space, double> cg_;
  ConjugateGradients<Space, float> narrow_cg_;
  std::vector<std::uint8_t> held_;     ///< degrees of freedom that tiles hold, by node
  std::unique_ptr<TileSolver> tiles_;  ///< of meshless solids alone; none where they cannot hold them
  bool extrapolates_;

  Pose taken_;               ///< where the last step of Newton's method started: u and D
  double taken_length_ = 0;  ///< 0: none led to the present state
  Array<Space, Tether> tethers_;

  Array<Space, double> report_, part_motion_, start_motion_;
  Array<Space, Mat3d> L_, tether_L_, extrapolated_L_;
  Array<Space, double> prescribed_;  ///< what is still to go, in constraint axes
  std::vector<double> report_values_;

  Array<Space, Mat3d> Q_, dA_;
  Array<Space, Vec3d> dx_;
  Array<Space, double> node_blocks_, inverse_, world_d_, world_y_, asked_, still_, still_Ap_, slope_, spin_;
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

  bool prescribed_left_ = false;
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
