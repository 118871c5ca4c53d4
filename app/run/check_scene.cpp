#include "app/diagnosis/condition.hpp"
#include "app/diagnosis/thickness.hpp"
#include "app/results/coupling_report.hpp"
#include "app/results/result_size.hpp"
#include "app/run/load_scene.hpp"
#include "app/run/memory.hpp"
#include "app/run/run_scene.hpp"
#include "app/tools.hpp"
#include "app/tune/kept_costs.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "assembly/simulation/step_limit.hpp"
#include "assembly/specification/readable.hpp"
#include "core/solver/mechanical_system.hpp"
#include "fascia/choose_backend.hpp"

#include <fmt/format.h>

#include <cmath>

namespace fascia::app {
namespace {

/// The model, and how many cells it has.
std::string describe(const SimulatedBody& b) {
  const BodyCells& cells = b.body->cells();
  if (cells.nodes.empty()) return b.body->model_name();
  if (cells.type == CellType::triangle)
    return fmt::format("{} of {} triangles", b.body->model_name(), cells.nodes.size() / 3);
  return fmt::format("{} {}{}", cells.nodes.size() / static_cast<std::size_t>(cells.nodes_per_cell),
                     cells.nodes_per_cell > node_count(cells.type) ? "quadratic " : "", b.body->model_name());
}

}  // namespace

int check_scene(const RunOptions& options) {
  Scene scene = read_scene(options);
  if (scene.states_need()) return tools().check_need(options, scene);
  Simulation s = load_scene(std::move(scene));
  const Backend backend = choose_backend(s);
  warn_of_backend(s, backend);
  const ResultSize results = forecast_result(s);
  warn_of_size(s, results);
  for (const SimulatedBody& b : s.bodies)
    fmt::print("body {}: {}, {}, {}{}, {:.6g} m3, {:.6g} kg ({})\n", b.name, describe(b),
               counted(at(b.body->node_count()), b.node_word()), counted(b.body->points().size(), "integration point"),
               b.body->selective() ? " (lambda at one point a cell)" : "", b.body->volume(), b.body->mass(),
               body_text(*b.body));
  for (const SimulatedBody& b : s.bodies)
    if (!b.body->quality().empty()) fmt::print("body {}: {}\n", b.name, b.body->quality());
  for (const SimulatedBody& b : s.bodies)
    for (const std::string& choice : b.body->choices()) fmt::print("body {}: {}\n", b.name, choice);
  for (std::size_t b = 0; b < s.bodies.size(); ++b)
    if (const std::string line = thickness_line(s, b); !line.empty())
      fmt::print("body {}: {}\n", s.bodies[b].name, line);
  for (const FluidOfBody& f : s.fluids)
    fmt::print("body {}: its fluid fills {:.6g} m3 at rest\n", s.bodies[at(f.body)].name,
               s.model.surfaces[at(f.surface)].rest_volume);
  fmt::print("{}", coupling_layout(s));
  const int free = s.model.free_dof_count(), followers = s.model.dependent_dof_count();
  const std::string tethers = s.model.tethers.empty() ? "" : fmt::format("{} tethers, ", s.model.tethers.size());
  fmt::print("{} unknowns ({} prescribed{}), {}{}, {}\n", free, s.model.constrained_dof_count(),
             followers > 0 ? fmt::format(", {} that follow others", followers) : "", tethers,
             counted(s.scene.loads.size(), "load"), counted(s.probes.size(), "probe"));
  if (s.stable_step > 0)
    fmt::print("{}, {}{} steps of {:.4g} s{}\n",
               std::isfinite(s.stable_step) ? fmt::format("stable time step {:.4g} s", s.stable_step)
                                            : "nothing elastic limits the time step",
               s.scene.solver.time_step_automatic ? "about " : "", s.scene.solver.steps, s.scene.solver.time_step,
               s.scene.solver.time_step_automatic ? " at first" : "");
  // Before the diagnosis, whose own memory is no run's.
  const double memory = run_memory(s, backend == Backend::cuda);
  if (s.stable_step > 0 && std::isfinite(s.stable_step)) {
    ThreadPool pool(s.scene.solver.threads);
    MechanicalSystem system(s.model, pool, settings_of(s.scene.solver));
    if (const StepLimit limit = step_limit(s, system); limit.body >= 0)
      fmt::print("the time step is limited by {}\n", limit.text);
  }
  if (const std::string condition = condition_line(s); !condition.empty()) fmt::print("{}\n", condition);
  fmt::print("memory: about {:.3g} MB\n", memory / 1e6);
  if (const std::string time = time_line(s); !time.empty()) fmt::print("{}\n", time);
  fmt::print("results: {}\n", results.text());
  if (s.scene.output.estimate)
    for (const std::string& line : tools().estimate_plan(s)) fmt::print("{}\n", line);
  if (backend == Backend::cuda) fmt::print("computed on the GPU\n");
  fmt::print("{} is sound; {} warning{}\n", options.scene.string(), s.warnings.size(),
             s.warnings.size() == 1 ? "" : "s");
  return kDone;
}

}  // namespace fascia::app
