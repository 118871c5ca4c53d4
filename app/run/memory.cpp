#include "app/run/memory.hpp"

#include "app/run/process_memory.hpp"
#include "app/run/recovery.hpp"
#include "assembly/bodies/bodies.hpp"
#include "assembly/bodies/domains.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/run/explicit_step.hpp"
#include "core/solver/mechanical_system.hpp"
#include "core/tangent/extrapolation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace fascia::app {

namespace {

/// A run reads more of the program and its libraries than a check: solvers, the writer of results.
constexpr double kCodeOfRun = 3.5e6;

constexpr double kLevels = 0.45;    // of the matrix's numbers: what levels hold
constexpr double kRounded = 0.67;   // of these once more: their rounded entries
constexpr long kGuessedSolves = 3;  // Newton iterations of a static solve

/// A number of bytes for people.
std::string in_words(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.3g} MB", bytes / 1e6) : fmt::format("{:.3g} GB", bytes / 1e9);
}

[[noreturn]] void refuse(const Scene& scene, const std::string& need, const FreeMemory& have, bool factor) {
  const auto largest = std::max_element(scene.bodies.begin(), scene.bodies.end(), [](const Body& a, const Body& b) {
    return estimated_samples(a).frames + estimated_samples(a).points <
           estimated_samples(b).frames + estimated_samples(b).points;
  });
  const SampleEstimate e = estimated_samples(*largest);
  const bool grid = std::holds_alternative<GridFrames>(largest->frames);
  const bool by_points = !std::holds_alternative<std::monostate>(largest->points) && e.points > 100 * e.frames;
  const bool cells = is_mesh_model(*largest) || is_shell(*largest);
  const Place& place = cells ? largest->cells_place : by_points ? largest->points_place : largest->frames_place;
  throw SceneError({{place, fmt::format("{:.6g} {} and {:.6g} {} need {}, {} are free{}; use {}{}", e.frames,
                                        cells ? "nodes" : "frames", e.points, cells ? "integration points" : "points",
                                        need, in_words(have.bytes), have.limit,
                                        cells       ? "fewer cells"
                                        : by_points ? "fewer points"
                                        : grid      ? "a smaller grid"
                                                    : "fewer frames",
                                        factor ? ", or solver.linear = { kind = \"cg\" }" : "")}});
}

/// What is allocated from now on: kept to the end, and the most at any moment, with what is kept.
class ToCome {
 public:
  void keep(double bytes) {
    kept_ += bytes;
    most_ += bytes;
  }
  void pass(double bytes) { most_ = std::max(most_, kept_ + bytes); }
  double most() const { return most_; }

 private:
  double kept_ = 0, most_ = 0;
};

/// A run saves one state, its last, which waits until the solvers are gone.
bool saves_last_alone(const Scene& scene, bool on_gpu) {
  return !on_gpu && scene.solver.kind == SolverKind::statics && scene.solver.control == StaticControl::load &&
         scene.output.every_steps == 0;
}

double state_bytes(const Model& model) {
  return static_cast<double>(model.node_count()) * (model.has_frames() ? 192 : 48) +
         8.0 * static_cast<double>(model.points.memory.size());
}

double vector_bytes(const Model& model) { return 8.0 * model.dof_count(); }

/// Bytes that the fields of results take at a place.
struct FieldBytes {
  double of_nodes = 24, of_tensors = 0;  ///< the rest position; what follows from tensors

  explicit FieldBytes(const Output& output, bool turns) {
    for (const std::string& name : output.fields) {
      if (name == "displacement") of_nodes += 24;
      if (name == "rotation" && turns) of_nodes += 24;
      if (name == "strain" || name == "stress") of_tensors += 72;
      if (name == "von_mises" || name == "energy_density") of_tensors += 8;
    }
  }
};

/// A body's state takes this while it is written: its values and tensors, their arrays, cells as VTK has them, and the
/// file, which stands in memory before it goes to the disk.
double output_bytes(const Simulation& s, const SimulatedBody& b) {
  constexpr double kFile = 0.5;  // of what is written: the compressed file and its copies
  const ModelBody& body = *b.body;
  const auto nodes = static_cast<double>(b.nodes.size()), points = static_cast<double>(body.points().size());
  const auto tensors = static_cast<double>(sizeof(PointTensors));
  const FieldBytes bytes(s.scene.output, !b.vertices);
  const double of_tensors = bytes.of_tensors > 0 ? tensors : 0;
  if (b.groups() != nullptr) {
    const BodyCells& cells = body.cells();
    const auto corners = static_cast<double>(cells.nodes.size()), count = corners / cells.nodes_per_cell;
    const double written = nodes * (24 + bytes.of_nodes + bytes.of_tensors) + count * bytes.of_tensors + 12 * corners;
    return std::max(points * of_tensors, (1 + kFile) * written) + (nodes + count) * of_tensors;
  }
  const auto surface = static_cast<double>(body.surface().points.size());
  const double values = surface + nodes + points;
  const double written = values * (24 + bytes.of_nodes + 72 + bytes.of_tensors) + 24.0 * (points + nodes) +
                         40.0 * static_cast<double>(body.surface().triangles.size());
  return (nodes + points) * of_tensors + values * (144 + of_tensors) + (1 + kFile) * written;
}

/// Results keep where the points of surfaces are attached.
double attachment_bytes(const Simulation& s) {
  double bytes = 0;
  for (const SimulatedBody& b : s.bodies) {
    if (b.groups() != nullptr || b.body->surface().points.empty()) continue;
    const Attachment a = b.body->attach_surface(0);
    bytes += static_cast<double>(b.body->surface().points.size()) *
             (sizeof(Attachment) + 48 + static_cast<double>(a.nodes.size()) * (sizeof(int) + sizeof(Influence)));
  }
  return bytes;
}

/// Results keep how strains at nodes follow from those at integration points.
double recovery_bytes(const Simulation& s) {
  double bytes = 0;
  for (const SimulatedBody& b : s.bodies) {
    if (!(FieldBytes(s.scene.output, true).of_tensors > 0) || b.body->points().empty()) continue;
    const auto shares = static_cast<double>(b.body->points().size() * b.body->attach_point(0).nodes.size());
    bytes += shares * sizeof(NodalRecovery::Share);
  }
  return bytes;
}

/// All that a run holds while it solves: set up, with what is still to come.
class Setup {
 public:
  Setup(const Simulation& s, bool on_gpu) : s_(s), pool_(s.scene.solver.threads) {
    if (s.scene.solver.kind == SolverKind::modes)
      of_modes();
    else
      of_steps(on_gpu);
    of_results(on_gpu);
  }
  /// Resident at most.
  double most() const { return std::max(resident_memory() + to_come_.most(), model_ + end_); }
  bool factorizes() const { return factorizes_; }

 private:
  /// Shares of recovery are found beside those by node, and attachments come and go.
  void of_results(bool on_gpu) {
    constexpr double kAsFound = 3;
    const double recovery = recovery_bytes(s_), attached = attachment_bytes(s_);
    double written = 0;
    for (const SimulatedBody& b : s_.bodies) written = std::max(written, output_bytes(s_, b));
    if (saves_last_alone(s_.scene, on_gpu)) {
      end_ = std::max(written + recovery, kAsFound * recovery) + attached + kCodeOfRun;
      to_come_.keep(kCodeOfRun);
      return;
    }
    to_come_.pass(written);
    to_come_.keep(attached + kCodeOfRun);
    to_come_.pass(kAsFound * recovery);
    to_come_.keep(recovery);
  }

  /// A run on a GPU makes a system of the processor too where it breaks off, or where the processor solves.
  void of_steps(bool on_gpu) {
    const Solver& solver = s_.scene.solver;
    system_.emplace(s_.model, pool_, settings_of(solver));
    state_ = s_.initial;
    if (solver.kind == SolverKind::central_differences) {
      const ExplicitPlan plan({.time_step = solver.time_step, .steps = 1}, 0);
      stepper_.emplace(*system_, state_, plan, [this](double time) { return s_.factors(time); });
      if (solver.time_step_automatic) stepper_->save();
      to_come_.keep(2 * state_bytes(s_.model));
      return;
    }
    const double dt = solver.kind == SolverKind::statics ? 0 : solver.time_step;
    system_->begin_step(state_, dt);
    system_->set_factors(s_.factors(0));
    system_->evaluate();
    linearize(dt);
    // Some twelve directions of GMRES, two vectors each, come beside where loads have no potential.
    const double directions = on_gpu || s_.model.loads_are_conservative() ? 0 : 24;
    // Points that remember stresses have what fades of them, and a linearisation keeps what they are given.
    to_come_.keep(8.0 * (6 + kGivenRows) * static_cast<double>(s_.model.points.memory.lanes()));
    // Schemes other than implicit Euler, which this system began with, keep what they predict.
    if (dt > 0 && scheme_of(solver.kind) != TimeScheme::implicit_euler)
      to_come_.keep(2.0 * sizeof(PoseMotion) * static_cast<double>(s_.model.node_count()));
    to_come_.keep(3 * state_bytes(s_.model) + (12 + directions) * vector_bytes(s_.model));
    if (!on_gpu && s_.model.free_dof_count() > 0) of_solver();
  }

  /// Newton's method holds this after a step that extrapolates stresses.
  void linearize(double dt) {
    if (dt > 0 && s_.model.points.damped) system_->executor().store_strain(state_, history_.E);
    if (dt > 0 && s_.model.points.damped) history_.inverse_step = 1 / dt;
    const Tangent tangent = settings_of(s_.scene.solver).tangent;
    if (extrapolates_stresses(s_.model.points, tangent))
      taken_ = {state_.u, state_.D, std::vector<double>(at(s_.model.dof_count()))};
    system_->executor().linearize(system_->state(), history_, tangent, lin_, true,
                                  taken_.u.empty() ? nullptr : &taken_);
  }

  void of_solver() {
    const Solver& solver = s_.scene.solver;
    TangentSolver& linear = system_->linear();
    BlockMatrix& matrix = linear.tangent().pattern();
    system_->executor().assemble(lin_, matrix);
    const bool load = solver.control == StaticControl::load, statics = solver.kind == SolverKind::statics;
    blocks_serve_ =
        !statics && s_.model.loads_are_conservative() && guessed_iterations() <= BlocksOrLevels({}).patience();
    linear.expect_inertia(blocks_serve_);
    factorizes_ = (statics && !load) || linear.direct() || solver.preconditioner == PreconditionerKind::cholesky ||
                  (statics && linear.gives_way_to_factor(guessed_cost())) ||
                  (statics && load && linear.factor_is_cheap(kGuessedSolves * guessed_cost())) ||
                  takes_kept_factor(linear);
    if (!factorizes_) return of_levels(matrix);
    if (solver.precision == "mixed" && !linear.direct()) to_come_.keep(rounded_bytes(matrix));
    to_come_.keep(linear.factor().cholesky().factor_bytes());
    const bool keeps = !statics && solver.linear == LinearMethod::automatic;
    if (keeps || solver.preconditioner == PreconditionerKind::cholesky)
      to_come_.keep(linear.factor().cholesky().rounded_bytes());
  }

  /// With inertia blocks take few iterations, however many their statics would.
  bool takes_kept_factor(TangentSolver& linear) const {
    if (!is_implicit_dynamics(s_.scene.solver.kind) || !s_.model.loads_are_conservative()) return false;
    linear.expect_inertia(true);
    linear.keep_factors(true);
    const bool takes = linear.gives_way_to_kept_factor(
        static_cast<double>(std::min<long>(guessed_iterations(), BlocksOrLevels({}).patience())));
    linear.expect_inertia(blocks_serve_);
    return takes;
  }

  /// Levels of rigid frames, where blocks would take too many iterations: a prolongator, and what it is made from.
  void of_levels(const BlockMatrix& matrix) {
    const PreconditionerKind kind = s_.scene.solver.preconditioner;
    const bool asked = kind == PreconditionerKind::multigrid;
    const Solver& solver = s_.scene.solver;
    const int most =
        solver.linear == LinearMethod::automatic ? BlocksOrLevels({}).patience() : solver.linear_max_iterations;
    const bool budget = solver.linear_max_iterations < CgOptions{}.max_iterations;
    const bool none =
        !asked && (kind != PreconditionerKind::automatic || budget || blocks_serve_ || guessed_iterations() < most);
    if (!none || solver.precision == "mixed") to_come_.keep(rounded_bytes(matrix));
    if (none) return;
    const double levels = kLevels * 8 * static_cast<double>(matrix.value_count());
    to_come_.pass(2 * levels);
    to_come_.keep((1 + kRounded) * levels);
  }

  /// CG takes about ten iterations a solve for each node along a body. At the end of statics a factor tells whether the
  /// equilibrium is stable, where it is cheap beside what CG has done.
  long guessed_iterations() const {
    double along = 1;
    for (const SimulatedBody& b : s_.bodies) {
      const Vec3d extent = bounds_of(b.nodes).extent();
      along = std::max(along, 1 + std::max({extent[0], extent[1], extent[2]}) / std::max(mean_spacing(b), 1e-300));
    }
    return std::lround(10 * std::min(along, static_cast<double>(s_.model.node_count())));
  }

  /// That of a solve in iterations with blocks: levels take their place where the choice is the program's.
  long guessed_cost() const {
    const Solver& solver = s_.scene.solver;
    const bool chosen =
        solver.linear == LinearMethod::automatic && solver.preconditioner == PreconditionerKind::automatic;
    return chosen ? std::min(guessed_iterations(), std::lround(BlocksOrLevels({}).expected())) : guessed_iterations();
  }

  /// The entries of a matrix once more, of 32 bits.
  static double rounded_bytes(const BlockMatrix& matrix) { return 4.0 * static_cast<double>(matrix.value_count()); }

  /// natural_modes() holds the matrix twice, its factor, the block of vectors with its products and copies.
  void of_modes() {
    constexpr int kBlocks = 6;
    const Model& model = s_.model;
    const int free = model.free_dof_count();
    if (free == 0) return;
    filter_.emplace(model);
    matrix_.emplace(model.points);
    state_ = State::at_rest(model);
    {
      CpuExecutor executor(model.points, pool_);
      std::vector<double> gradient(at(model.dof_count()));
      executor.gradient(state_, {}, gradient);
      Linearization lin;
      executor.linearize(state_, {}, Tangent::full, lin);
      executor.assemble(lin, *matrix_);
    }
    factor_.emplace(*matrix_, *filter_, nullptr, &pool_);
    factorizes_ = true;
    to_come_.pass(factor_->factor_bytes() + 8.0 * static_cast<double>(matrix_->value_count()));
    to_come_.keep(factor_->factor_bytes());
    const int wanted = std::min(s_.scene.solver.modes, free), block = std::min(free, std::max(2 * wanted, wanted + 8));
    to_come_.keep(wanted * vector_bytes(model));
    to_come_.pass(kBlocks * block * vector_bytes(model));
  }

  const Simulation& s_;
  ThreadPool pool_;
  std::optional<MechanicalSystem> system_;
  std::optional<ExplicitStepper> stepper_;
  std::optional<DofFilter> filter_;
  std::optional<BlockMatrix> matrix_;
  std::optional<BlockCholesky> factor_;
  State state_;
  StrainHistory history_;
  TakenStep taken_;
  Linearization lin_;
  const double model_ = resident_memory();
  ToCome to_come_;
  double end_ = 0;  ///< of results beside the model, when solvers are gone
  bool factorizes_ = false;
  bool blocks_serve_ = false;  ///< in implicit dynamics, where inertia makes them quick
};

}  // namespace

double estimated_memory(const Scene& scene) {
  double bytes = 30e6;  // the program itself
  for (const Body& b : scene.bodies) {
    const SampleEstimate e = estimated_samples(b);
    // Per point: shapes of its frames, stress and strain, results. Per frame: blocks of the matrix, vectors; and the
    // fill of a factor, which grows with the section, where one is made whatever its size.
    const double dofs = (is_mesh_model(b) ? 3 : b.affine ? 12 : 6) * e.frames;
    const double block = is_mesh_model(b) ? 0.25 : b.affine ? 4 : 1;
    const bool factor = scene.solver.linear == LinearMethod::cholesky || dofs <= 15000;
    bytes += e.points * (is_mesh_model(b) ? 300 + 60.0 * e.neighbours : 500 + 250.0 * e.neighbours) +
             e.frames * (e.coupled * 300 * block + 1000 + (factor ? 36 * 8 * 6 * block * std::cbrt(e.frames) : 0.0)) +
             e.pieces * 160;
  }
  return bytes;
}

void check_memory(const Scene& scene) {
  constexpr double kMost = 2e11;  // numbers of things are of 32 bits
  const double need = estimated_memory(scene);
  const FreeMemory have = free_memory();
  if (need > have.bytes || need >= kMost) refuse(scene, "about " + in_words(need), have, false);
}

double run_memory(const Simulation& s, bool on_gpu) {
  const FreeMemory have = free_memory();
  try {
    const Setup setup(s, on_gpu);
    return std::max(peak_memory(), setup.most());
  } catch (const std::bad_alloc&) {
    refuse(s.scene, "more memory", have, false);
  }
}

void check_run_memory(const Simulation& s, bool on_gpu) {
  constexpr double kSafe = 8;  // the rough figure errs by less
  const FreeMemory have = free_memory();
  if (kSafe * estimated_memory(s.scene) < have.bytes) return;
  const double before = resident_memory();
  double need = 0;
  bool factor = false;
  try {
    const Setup setup(s, on_gpu);
    need = setup.most() - before;
    factor = setup.factorizes();
  } catch (const std::bad_alloc&) {
    refuse(s.scene, "more memory", have, false);
  }
  if (need > have.bytes) refuse(s.scene, fmt::format("about {} beside the model", in_words(need)), have, factor);
}

}  // namespace fascia::app
