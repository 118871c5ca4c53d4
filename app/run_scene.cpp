#include "app/run_scene.hpp"

#include "app/picture.hpp"
#include "app/progress.hpp"
#include "app/results.hpp"
#include "app/scene/parse.hpp"
#include "app/simulation.hpp"
#include "core/math/rotation.hpp"
#include "core/solver/modes.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <csignal>

namespace fascia::app {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

volatile std::sig_atomic_t interrupted = 0;
void on_interrupt(int) { interrupted = 1; }

SolverSettings settings_of(const Solver& solver) {
  SolverSettings s;
  s.max_iterations = solver.newton_max_iterations;
  s.tolerance = solver.newton_tolerance;
  s.proceed_on_limit = solver.on_limit == OnLimit::proceed;
  s.linear = solver.linear == LinearKind::cg         ? LinearMethod::cg
             : solver.linear == LinearKind::cholesky ? LinearMethod::cholesky
                                                     : LinearMethod::automatic;
  switch (solver.preconditioner) {
    case PreconditionerKind::automatic:
      s.preconditioner = Preconditioner::automatic;
      break;
    case PreconditionerKind::none:
      s.preconditioner = Preconditioner::none;
      break;
    case PreconditionerKind::jacobi:
      s.preconditioner = Preconditioner::jacobi;
      break;
    case PreconditionerKind::block_jacobi:
      s.preconditioner = Preconditioner::block_jacobi;
      break;
    case PreconditionerKind::cholesky:
      s.preconditioner = Preconditioner::cholesky;
      break;
  }
  s.cg.max_iterations = solver.linear_max_iterations;
  s.cg.tolerance = solver.linear_tolerance;
  s.tangent = solver.full_tangent ? Tangent::full : Tangent::material;
  return s;
}

Simulation load(const RunOptions& options) {
  Scene scene = parse_scene_file(options.scene, options.overrides);
  if (options.output) scene.output.directory = *options.output;
  if (options.backend) scene.solver.backend = *options.backend;
  if (options.threads) scene.solver.threads = *options.threads;
  if (scene.solver.backend == "cuda") throw BackendError("backend \"cuda\" is not in this build; use --backend cpu");
  Simulation s = build_simulation(std::move(scene));
  for (const std::string& w : s.warnings) fmt::print(stderr, "{}: warning: {}\n", options.scene.string(), w);
  return s;
}

/// Saved steps of a dynamic run: every so many seconds or steps, 25 a simulated second otherwise, and the last.
class SaveRule {
 public:
  SaveRule(const Output& output, bool statics)
      : every_(output.every), every_steps_(output.every_steps), statics_(statics) {
    if (!statics && every_ == 0 && every_steps_ == 0) every_ = 0.04;
  }
  bool save(const StepInfo& step) {
    if (step.progress >= 1) return true;
    if (every_steps_ > 0) return step.step % every_steps_ == 0;
    if (statics_ || every_ <= 0) return false;
    const double count = std::floor(step.time / every_ * (1 + 1e-9));
    const bool due = count > saved_;
    saved_ = std::max(saved_, count);
    return due;
  }

 private:
  double every_;
  int every_steps_;
  bool statics_;
  double saved_ = 0;
};

struct Outcome {
  RunReport run;
  std::vector<std::string> warnings;
  RunTimes times;
  std::vector<nlohmann::json> probes;
  double stabilization = 0;
};

/// Looks for load steps in which the elastic energy falls by half although every load and motion grew: the body found
/// another equilibrium, which may lack a turn that it was given.
class SnapWatch {
 public:
  explicit SnapWatch(const Simulation& s) : simulation_(s), factors_(s.factors(0)) {
    for (const SimulatedBody& b : s.bodies)
      for (const BodyPoint& p : b.meshless->points()) scale_ += p.mu * p.volume;
  }

  void look(double time, double energy) {
    const std::vector<double> factors = simulation_.factors(time);
    bool grew = true;
    for (std::size_t i = 0; i < factors.size(); ++i) grew = grew && std::abs(factors[i]) >= std::abs(factors_[i]);
    // Energies of rounding are no energies: strains of 1e-8.
    if (grew && energy < 0.5 * energy_ && energy_ > 1e-16 * scale_ && warning_.empty())
      warning_ = fmt::format(
          "the elastic energy fell from {:.3g} J to {:.3g} J on the way to load factor {:.4g}, though nothing was "
          "unloaded: the body snapped to another equilibrium, perhaps one that lost a turn; compare with more frames",
          energy_, energy, time);
    energy_ = energy;
    factors_ = factors;
  }
  const std::string& warning() const { return warning_; }

 private:
  const Simulation& simulation_;
  std::vector<double> factors_;
  double scale_ = 0, energy_ = 0;
  std::string warning_;
};

/// Determinant of the mean of two rotations a right angle apart: below, a blend no longer follows them.
constexpr double kResolved = 0.5;

/// What a user must know of a result that converged.
void add_result_warnings(const Simulation& s, const State& end, RunReport& run, std::vector<std::string>& warnings) {
  if (run.status == RunStatus::converged && !run.trouble.empty())
    warnings.push_back("the end state may be an unstable equilibrium: " + run.trouble);
  if (run.residual_floor > 1e-3 && !s.model.loads.empty())
    warnings.push_back(fmt::format(
        "rounding leaves {:.1e} of the loads: they are tiny beside the stiffness and the motion", run.residual_floor));
  for (const SimulatedBody& b : s.bodies) {
    int inverted = 0, unresolved = 0;
    const bool rigid = s.model.kind(b.meshless->first_frame()) == FrameKind::rigid;
    for (std::size_t q = 0; q < b.meshless->points().size(); ++q) {
      const FieldValue f = field_at(b.meshless->attach_point(q), end);
      inverted += determinant(Mat3d::identity() + f.H) <= 0 ? 1 : 0;
      unresolved += rigid && determinant(Mat3d::identity() + f.D) < kResolved ? 1 : 0;
    }
    if (inverted > 0)
      warnings.push_back(
          fmt::format("body \"{}\" is turned inside out at {} of {} integration points: St Venant-Kirchhoff does "
                      "not resist that; the result is no physical state",
                      b.name, inverted, b.meshless->points().size()));
    if (unresolved > 0)
      warnings.push_back(
          fmt::format("body \"{}\": neighbouring frames are turned against each other by more than a right angle at {} "
                      "of {} integration points: their blend does not resolve that; use more frames",
                      b.name, unresolved, b.meshless->points().size()));
  }
  if (run.steps_at_limit > 0 && run.status == RunStatus::converged) {
    run.status = RunStatus::not_converged;
    run.message =
        fmt::format("{} steps were accepted above the tolerance (newton.on_limit = \"continue\")", run.steps_at_limit);
  }
}

Outcome simulate(const Simulation& s, ThreadPool& pool, ResultFiles& files, const RunOptions& options) {
  Outcome out;
  const Clock::time_point setup = Clock::now();
  const SolverSettings settings = settings_of(s.scene.solver);
  const bool statics = s.scene.solver.kind == SolverKind::statics;
  MechanicalSystem system(s.model, pool, settings);
  State state = s.initial;
  out.times.setup = seconds_since(setup);
  Progress progress(options.quiet || options.json, options.verbose);
  SaveRule rule(s.scene.output, statics);
  const FactorFunction factors = [&](double t) { return s.factors(t); };
  double output_seconds = 0, saved_time = -1;
  SnapWatch snaps(s);
  const auto save = [&](double time, const State& at, bool fields) {
    const Clock::time_point start = Clock::now();
    files.add_probes(time, {&at, &system, 0});
    if (fields) files.add_state(time, at);
    if (fields) saved_time = time;
    output_seconds += seconds_since(start);
  };
  const auto observe = [&](const StepInfo& step, const State& at, MechanicalSystem&) {
    out.times.steps.push_back(step.seconds);
    progress.update(step);
    const bool due = rule.save(step);
    if (due || statics) save(step.time, at, due);
    out.stabilization = system.internal_energy().stabilization;
    if (statics) snaps.look(step.time, system.internal_energy().elastic);
    return interrupted == 0;
  };
  const Clock::time_point start = Clock::now();
  if (statics) {
    out.run = run_statics(system, state, factors, settings, {s.scene.solver.load_steps}, observe);
  } else {
    system.set_factors(factors(0));
    system.begin_step(state, 0);
    system.evaluate();
    save(0, state, true);
    out.run =
        run_implicit_euler(system, state, factors, settings, {s.scene.solver.time_step, s.scene.solver.steps}, observe);
  }
  progress.finish();
  out.times.solve = seconds_since(start) - output_seconds;
  // What was computed up to a failure is a result too.
  if (out.run.status != RunStatus::converged && saved_time != state.time) {
    if (statics && out.run.steps > 0) {
      files.add_state(state.time, state);
    } else {
      system.set_factors(factors(state.time));
      system.begin_step(state, 0);
      system.evaluate();
      save(state.time, state, true);
    }
  }
  add_result_warnings(s, state, out.run, out.warnings);
  if (!snaps.warning().empty()) out.warnings.push_back(snaps.warning());
  out.times.output = output_seconds;
  if (out.run.status == RunStatus::interrupted) out.run.message = fmt::format("interrupted at {:.6g}", out.run.time);
  for (std::size_t i = 0; i < s.probes.size(); ++i) out.probes.push_back(probe_json(s.probes[i], files.last_values(i)));
  return out;
}

/// Stabilisation holds a hundredth of a body's own modes, and a tenth and more of those of badly coupled frames.
constexpr double kHollow = 0.1;

Outcome find_modes(const Simulation& s, ThreadPool& pool, ResultFiles& files) {
  Outcome out;
  const Clock::time_point start = Clock::now();
  const Modes modes = natural_modes(s.model, pool, s.scene.solver.modes);
  out.times.solve = seconds_since(start);
  out.run.steps = static_cast<int>(modes.frequency.size());
  out.run.linear_iterations = modes.iterations;
  if (!modes.converged) {
    out.run.status = RunStatus::not_converged;
    out.run.message = "the subspace iteration did not settle; ask for fewer modes";
  }
  int hollow = 0, first_hollow = 0;
  for (std::size_t m = 0; m < modes.stabilization.size(); ++m)
    if (modes.stabilization[m] > kHollow && hollow++ == 0) first_hollow = static_cast<int>(m) + 1;
  if (hollow > 0)
    out.warnings.push_back(
        fmt::format("{} modes (the first: number {}) are motions of frames that the material hardly feels, held by "
                    "stabilisation: they are no modes of the body; use more rigid frames, on a grid",
                    hollow, first_hollow));
  std::vector<nlohmann::json> frequencies(s.probes.size(), nlohmann::json::array());
  double size = 0;
  for (const SimulatedBody& b : s.bodies) size = std::max(size, b.meshless->size());
  for (std::size_t m = 0; m < modes.frequency.size(); ++m) {
    State state = State::at_rest(s.model);
    double largest = 0;
    const DofLayout& dofs = s.model.points.dofs;
    for (int i = 0; i < dofs.node_count(); ++i) {
      const double* d = modes.shape[m].data() + dofs.begin(i);
      largest = std::max(largest, std::hypot(d[0], d[1], d[2]));
    }
    const double scale = 0.1 * size / std::max(largest, 1e-300);
    for (int i = 0; i < dofs.node_count(); ++i) {
      const double* d = modes.shape[m].data() + dofs.begin(i);
      state.u[at(i)] = Vec3d{{d[0], d[1], d[2]}} * scale;
      const bool rigid = dofs.kind(i) == FrameKind::rigid;
      state.D[at(i)] = rigid ? rotation_increment(Vec3d{{d[3], d[4], d[5]}} * scale)
                             : frame_variation(FrameKind::affine, d + 3, {}) * scale;
    }
    const auto number = static_cast<double>(m + 1);
    files.add_probes(number, {&state, nullptr, modes.frequency[m]});
    files.add_state(number, state);
    for (std::size_t i = 0; i < s.probes.size(); ++i) {
      const nlohmann::json value = probe_json(s.probes[i], files.last_values(i));
      if (s.probes[i].probe->quantity == Quantity::frequency)
        frequencies[i].push_back(value);
      else
        frequencies[i] = value;
    }
  }
  out.probes = std::move(frequencies);
  out.times.output = files.seconds();
  return out;
}

void print_summary(const nlohmann::ordered_json& j, const std::filesystem::path& directory) {
  fmt::print("{}: {} unknowns, {} steps, {} Newton iterations, {:.2f} s\n", j["status"].get<std::string>(),
             j["dofs"].get<int>(), j["steps"].get<int>(), j["newton_iterations"].get<int>(),
             j["seconds"]["solve"].get<double>());
  for (const auto& [name, probe] : j["probes"].items())
    fmt::print("  {} ({}): {} {}\n", name, probe["quantity"].get<std::string>(), probe["value"].dump(),
               probe["unit"].get<std::string>());
  fmt::print("results in {}\n", directory.string());
}

int exit_status(RunStatus status) {
  if (status == RunStatus::interrupted) return kInterrupted;
  return status == RunStatus::converged ? kDone : kNotConverged;
}

}  // namespace

int run_scene(const RunOptions& options) {
  const Clock::time_point start = Clock::now();
  Simulation s = load(options);
  io::ResultDirectory directory(s.scene.output.directory);
  ThreadPool pool(s.scene.solver.threads);
  const std::string name = s.scene.path.stem().string();
  ResultFiles files(s, directory.path(), name);
  const double setup = seconds_since(start);
  std::signal(SIGINT, on_interrupt);
  Outcome out =
      s.scene.solver.kind == SolverKind::modes ? find_modes(s, pool, files) : simulate(s, pool, files, options);
  out.times.setup += setup;
  files.finish();
  if (s.scene.output.picture) make_picture(s, directory.path(), name);
  for (const std::string& w : out.warnings) {
    fmt::print(stderr, "{}: warning: {}\n", options.scene.string(), w);
    s.warnings.push_back(w);
  }
  const nlohmann::ordered_json j = summary(s, out.run, out.times, pool.size(), out.probes, out.stabilization);
  io::write_text(directory.path() / "summary.json", j.dump(2) + "\n");
  directory.commit();
  if (options.json)
    fmt::print("{}\n", j.dump(2));
  else if (!options.quiet)
    print_summary(j, s.scene.output.directory);
  if (out.run.status != RunStatus::converged) fmt::print(stderr, "{}: {}\n", options.scene.string(), out.run.message);
  if (out.run.steps_at_limit > 0) return kDone;  // as asked for
  return exit_status(out.run.status);
}

int check_scene(const RunOptions& options) {
  const Simulation s = load(options);
  for (const SimulatedBody& b : s.bodies)
    fmt::print("body {}: meshless, {} frames, {} integration points{}, {:.6g} m3, {:.6g} kg\n", b.name,
               b.meshless->frame_count(), b.meshless->points().size(),
               b.meshless->selective() ? " (lambda at one point a cell)" : "", b.meshless->volume(),
               b.meshless->mass());
  for (const SimulatedBody& b : s.bodies)
    if (!b.meshless->quality().empty()) fmt::print("body {}: {}\n", b.name, b.meshless->quality());
  const int free = s.model.dof_count() - s.model.constrained_dof_count();
  const std::string tethers = s.model.tethers.empty() ? "" : fmt::format("{} tethers, ", s.model.tethers.size());
  fmt::print("{} unknowns ({} prescribed), {}{} loads, {} probes\n", free, s.model.constrained_dof_count(), tethers,
             s.scene.loads.size(), s.probes.size());
  fmt::print("memory: about {:.3g} MB\n", model_memory(s) / 1e6);
  fmt::print("{} is sound; {} warning{}\n", options.scene.string(), s.warnings.size(),
             s.warnings.size() == 1 ? "" : "s");
  return kDone;
}

}  // namespace fascia::app
