// Stages of the time steps of a scene: step_benchmark SCENE [--set KEY=VALUE]...
#include "app/reader/parse.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/clock.hpp"
#include "core/base/errors.hpp"
#include "core/run/drivers.hpp"
#include "core/tangent/condensation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::app {
namespace {

constexpr double kMeasuredSeconds = 1;

/// Shortest time of a call [ms]: what else the machine does only adds to it.
double shortest(const std::function<void()>& call) {
  double best = std::numeric_limits<double>::max();
  const Clock::time_point start = Clock::now();
  for (int i = 0; i < 5 || seconds_since(start) < kMeasuredSeconds; ++i) {
    const Clock::time_point began = Clock::now();
    call();
    best = std::min(best, seconds_since(began));
  }
  return 1e3 * best;
}

/// The points of all meshless bodies, which share one set of groups.
PointSet frames_only(PointSet set) {
  set.shells.clear();
  set.blocks.clear();
  set.springs.clear();
  set.dependents.clear();
  return set;
}

/// The elements of one body alone.
PointSet elements_only(PointSet set, const ModelBody& body) {
  const auto keep = [](auto& blocks, const BodyBlocks::Run& run) {
    blocks.erase(blocks.begin() + run.end(), blocks.end());
    blocks.erase(blocks.begin(), blocks.begin() + run.first);
  };
  keep(set.shells, body.blocks.shells);
  keep(set.blocks, body.blocks.elements);
  set.springs.clear();
  set.dependents.clear();
  set.slot_begin = {0};
  set.slot_node.clear();
  set.node_slot.clear();
  std::fill(set.node_slot_begin.begin(), set.node_slot_begin.end(), 0);
  set.color_begin = {0};
  set.color_group.clear();
  set.rule.clear();
  return set;
}

struct Stages {
  double gradient = 0, linearize = 0, assemble = 0;  ///< [ms]
};

/// Internal forces, their derivatives and the matrix of a point set.
/// @param time_step  of the viscous stress [s]
Stages measure(const PointSet& set, ThreadPool& pool, const State& state, double time_step, Tangent tangent) {
  CpuExecutor executor(set, pool);
  std::vector<double> gradient(static_cast<std::size_t>(set.dofs.total()));
  StrainHistory history;
  if (set.damped) {
    executor.store_strain(state, history.E);
    history.inverse_step = 1 / time_step;
  }
  Linearization lin;
  Stages t;
  t.gradient = shortest([&] { executor.gradient(state, history, gradient); });
  t.linearize = shortest([&] { executor.linearize(state, history, tangent, lin); });
  BlockMatrix matrix(set);
  Dependents<PoolSpace> dependents(set, PoolSpace(pool));
  Condensation condensation(dependents, set.dofs, pool);
  t.assemble = shortest([&] {
    executor.assemble(lin, matrix);
    if (dependents.empty()) return;
    dependents.turn_to(lin.Q.data());
    condensation.condense(matrix);
  });
  return t;
}

void print_row(const std::string& name, double ms) { fmt::print("  {:<40} {:>9.3f}\n", name, ms); }

void print_body(const std::string& name, const Stages& t) {
  fmt::print("  {:<24} {:>9.3f} {:>9.3f} {:>9.3f}\n", name, t.gradient, t.linearize, t.assemble);
}

/// At the state where the run ended: one Newton iteration of the step to come.
void measure_iteration(const Simulation& s, MechanicalSystem& system, const State& state,
                       const SolverSettings& settings) {
  ThreadPool& pool = system.executor().pool();
  const double dt = s.scene.solver.time_step;
  const Stages whole = measure(s.model.points, pool, state, dt, settings.tangent);
  system.begin_step(state, dt);
  system.set_factors(s.factors(state.time + dt));
  system.evaluate();
  int iterations = 0;
  const double direction = shortest([&] { iterations = system.direction().linear_iterations; });
  fmt::print("one Newton iteration [ms]\n");
  print_row("gradient", whole.gradient);
  print_row("direction: all below", direction);
  print_row("linearize", whole.linearize);
  print_row("assemble", whole.assemble);
  std::vector<double> x(static_cast<std::size_t>(s.model.dof_count())), y = x;
  TangentSolver& linear = system.linear();
  const BlockMatrix& matrix = linear.tangent().matrix();
  if (linear.direct()) {
    print_row("factor", shortest([&] { linear.factor().cholesky().factorize(matrix); }));
    print_row("solve", shortest([&] { linear.factor().cholesky().solve(system.gradient(), x); }));
  } else {
    print_row(fmt::format("conjugate gradients, {} iterations", iterations),
              direction - whole.linearize - whole.assemble);
    print_row("product of one iteration", shortest([&] { matrix.multiply(pool, system.gradient(), y); }));
  }
  fmt::print("bodies alone [ms]          gradient linearize  assemble\n");
  std::string meshless;
  for (const SimulatedBody& b : s.bodies) {
    if (b.body->blocks.groups.count > 0) meshless += (meshless.empty() ? "" : ", ") + b.name;
    if (b.body->blocks.shells.count + b.body->blocks.elements.count > 0)
      print_body(b.name, measure(elements_only(s.model.points, *b.body), pool, state, dt, settings.tangent));
  }
  if (!meshless.empty()) print_body(meshless, measure(frames_only(s.model.points), pool, state, dt, settings.tangent));
}

int run(int argc, char** argv) {
  std::vector<std::string> overrides;
  for (int i = 2; i + 1 < argc; i += 2)
    if (std::string_view(argv[i]) == "--set") overrides.emplace_back(argv[i + 1]);
  if (argc < 2 || argc != 2 + 2 * static_cast<int>(overrides.size()))
    throw InputError("usage: step_benchmark SCENE [--set KEY=VALUE]...");
  const Simulation s = build_simulation(parse_scene_file(argv[1], overrides));
  const Solver& solver = s.scene.solver;
  if (solver.steps == 0 || solver.kind == SolverKind::central_differences)
    throw InputError("the scene must be one of implicit dynamics");
  const SolverSettings settings = settings_of(solver);
  ThreadPool pool(solver.threads);
  MechanicalSystem system(s.model, pool, settings);
  State state = s.initial;
  std::vector<double> steps;
  const RunReport report = run_implicit(
      system, state, [&](double t) { return s.factors(t); }, settings,
      {scheme_of(solver.kind), solver.time_step, solver.steps},
      [&](const StepInfo& step, const State&, MechanicalSystem&) {
        steps.push_back(step.seconds);
        return true;
      });
  if (steps.empty()) throw InputError(report.message);
  std::sort(steps.begin(), steps.end());
  const auto count = static_cast<double>(steps.size());
  std::size_t points = 0;
  for (const SimulatedBody& b : s.bodies) points += b.body->points().size();
  fmt::print("{}: {} nodes, {} unknowns, {} integration points, {} threads\n", s.scene.path.filename().string(),
             s.model.node_count(), s.model.free_dof_count(), points, pool.size());
  fmt::print(
      "{} steps: median {:.2f} ms, shortest {:.2f} ms, longest {:.2f} ms; {:.1f} Newton and {:.1f} linear iterations "
      "each\n",
      steps.size(), 1e3 * steps[steps.size() / 2], 1e3 * steps.front(), 1e3 * steps.back(),
      report.newton_iterations / count, report.linear_iterations / count);
  if (s.model.points.group_count() > 0)
    fmt::print("{} groups of up to {} points with {:.1f} frames each\n", s.model.points.group_count(), kGroupSize,
               s.model.points.slot_count() / static_cast<double>(s.model.points.group_count()));
  measure_iteration(s, system, state, settings);
  return 0;
}

}  // namespace
}  // namespace fascia::app

int main(int argc, char** argv) {
  try {
    return fascia::app::run(argc, argv);
  } catch (const fascia::SceneError& e) {
    for (const auto& d : e.diagnostics()) fmt::print(stderr, "{}\n", d.text());
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
  }
  return 2;
}
