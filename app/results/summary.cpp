#include "app/results/coupling_report.hpp"
#include "app/results/picture.hpp"
#include "app/results/results.hpp"
#include "app/run/process_memory.hpp"
#include "app/version.hpp"
#include "fascia/choose_backend.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdint>

namespace fascia::app {

namespace {

/// JSON has no NaN: a number that is not finite is a bug caught before, and would read null here.
double finite(double v) { return std::isfinite(v) ? v : 0.0; }

nlohmann::ordered_json bodies_of(const Simulation& s) {
  nlohmann::ordered_json bodies = nlohmann::ordered_json::object();
  for (const SimulatedBody& b : s.bodies) {
    bodies[b.name] = {
        {"model", b.body->model_name()},
        {"frames", b.vertices ? 0 : b.body->node_count()},
        {"shared", b.body->shared_nodes().size()},
        {"points", b.body->points().size()},
        {"cells", b.body->cells().nodes.size() / static_cast<std::size_t>(b.body->cells().nodes_per_cell)},
        {"volume", b.body->volume()},
        {"mass", b.body->mass()}};
    if (b.vertices) bodies[b.name]["nodes"] = b.body->node_count();
  }
  return bodies;
}

/// Every summary begins with this.
nlohmann::ordered_json summary_head(const Simulation& s, const std::string& status, const std::string& message) {
  nlohmann::ordered_json j;
  j["fascia"] = FASCIA_VERSION;
  j["scene"] = s.scene.path.filename().string();
  if (!s.scene.title.empty()) j["title"] = s.scene.title;
  j["status"] = status;
  j["message"] = message;
  return j;
}

}  // namespace

const char* status_name(RunStatus status) {
  switch (status) {
    case RunStatus::converged:
      return "converged";
    case RunStatus::diverged:
      return "diverged";
    case RunStatus::unstable:
      return "unstable";
    case RunStatus::inverted:
      return "inverted";
    case RunStatus::interrupted:
      return "interrupted";
    default:
      return "not-converged";
  }
}

nlohmann::ordered_json running_summary(const Simulation& s, const nlohmann::ordered_json& provenance) {
  nlohmann::ordered_json j = summary_head(s, "running", "");
  j["bodies"] = bodies_of(s);
  j["dofs"] = s.model.free_dof_count();
  j["steps"] = 0;
  j["warnings"] = s.warnings.summary();
  j["provenance"] = provenance;
  return j;
}

nlohmann::ordered_json summary(const Simulation& s, const RunEnd& end, const RunTimes& times, int threads,
                               const std::vector<nlohmann::json>& probe_values,
                               const nlohmann::ordered_json& provenance) {
  const RunReport& run = end.report;
  const bool modes = s.scene.solver.kind == SolverKind::modes;  // about the rest state, where nothing acts
  nlohmann::ordered_json j = summary_head(s, status_name(run.status), run.message);
  j["convergence"] = run.convergence;
  j["backend"] = name_of(end.backend);
  j["gpus"] = end.gpus;
  j["precision"] = precision_of(s, end.backend, run.linear_iterations > 0);
  j["threads"] = threads;
  j["library"] = tuning();
  j["bodies"] = bodies_of(s);
  for (std::size_t f = 0; f < (modes ? 0 : s.fluids.size()); ++f) {
    const FluidState fluid = fluid_state(s, static_cast<int>(f), end.state);
    j["bodies"][s.bodies[static_cast<std::size_t>(s.fluids[f].body)].name]["fluid"] = {
        {"volume", finite(fluid.volume)}, {"pressure", finite(fluid.pressure)}};
  }
  j["couplings"] = nlohmann::ordered_json::object();
  if (!modes)
    for (const auto& [name, report] : coupling_report(s, end.acting, end.state)) j["couplings"][name] = report;
  j["dofs"] = s.model.free_dof_count();
  j["steps"] = run.steps;
  j["simulated_time"] = is_dynamic(s.scene.solver.kind) ? run.time : 0.0;
  j["newton_iterations"] = run.newton_iterations;
  j["linear_iterations"] = run.linear_iterations;
  j["residual"] = finite(run.residual);
  j["residual_floor"] = finite(run.residual_floor);
  j["stabilization_energy"] = finite(end.stabilization);
  j["seconds"] = {{"setup", times.setup},
                  {"solve", times.solve},
                  {"output", times.output},
                  {"solve_processor", times.processor},
                  {"step_median", times.steps.percentile(0.5)},
                  {"step_p99", times.steps.percentile(0.99)},
                  {"step_p999", times.steps.percentile(0.999)},
                  {"step_max", times.steps.percentile(1.0)}};
  if (const std::optional<double>& budget = s.scene.solver.budget)
    j["budget"] = {{"seconds", *budget},
                   {"cut_steps", times.budget.cut},
                   {"idle_steps", times.budget.idle},
                   {"late_steps", times.budget.late},
                   {"residual_max", finite(times.budget.most_left)}};
  j["peak_memory_bytes"] = static_cast<std::uint64_t>(peak_memory());
  j["warnings"] = s.warnings.summary();
  j["doubts"] = run.doubts;
  j["probes"] = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < s.probes.size(); ++i) {
    const Probe& p = *s.probes[i].probe;
    j["probes"][p.name] = {
        {"quantity", quantity_name(p.quantity)}, {"unit", probe_unit(p.quantity)}, {"value", probe_values[i]}};
  }
  if (const std::optional<Vec3d> up = up_of(s.scene.world)) j["up"] = {(*up)[0], (*up)[1], (*up)[2]};
  j["provenance"] = provenance;
  return j;
}

}  // namespace fascia::app
