#include "fascia/simulate.hpp"

#include "assembly/build/build_simulation.hpp"
#include "assembly/specification/check.hpp"
#include "core/base/index.hpp"
#include "fascia/choose_backend.hpp"
#include "fascia/run/run_simulation.hpp"

#include <utility>

namespace fascia {

namespace {

Rows rows_of(const std::vector<Vec3d>& values) {
  return {values.empty() ? nullptr : values[0].v, static_cast<int>(values.size()), 3};
}

}  // namespace

/// Hands the states of a run to a function.
class RunStates final : public RunListener {
 public:
  RunStates(const Simulation& simulation, const std::function<bool(const RunState&)>& look, const std::stop_token& stop)
      : simulation_(simulation), look_(look), stop_(stop) {}

  bool stops() override { return stops_ || stop_.stop_requested(); }
  bool leaves_step() override { return stop_.stop_requested(); }
  void show(double time, const ProbedState& at, const ProbeValues& values) override {
    if (look_ && !look_(RunState(time, simulation_, at, values))) stops_ = true;
  }

 private:
  const Simulation& simulation_;
  const std::function<bool(const RunState&)>& look_;
  const std::stop_token& stop_;
  bool stops_ = false;
};

namespace {

RunOutcome outcome_of(const Simulation& s, RunEnd end) {
  RunReport& run = end.report;
  RunOutcome out;
  out.status = run.status;
  out.done = end.done();
  out.message = std::move(run.message);
  out.time = run.time;
  out.seconds = end.solve_seconds;
  out.residual = run.residual;
  out.steps = run.steps;
  out.newton_iterations = run.newton_iterations;
  out.linear_iterations = run.linear_iterations;
  out.backend = end.backend;
  out.gpus = end.gpus;
  Warnings warnings = s.warnings;
  warnings.add(end.warnings);
  out.warnings = warnings.summary();
  out.doubts = std::move(run.doubts);
  out.frequencies = std::move(end.frequencies);
  return out;
}

}  // namespace

Rows RunState::rest_positions() const { return rows_of(simulation_.model.rest_position); }
Rows RunState::displacements() const { return rows_of(at_.state->u); }
Rows RunState::velocities() const { return rows_of(at_.state->v); }
std::vector<double> RunState::probe(std::string_view name) const { return values_[probe_index(simulation_, name)]; }

RunOutcome simulate(Scene scene, const std::function<bool(const RunState&)>& look, const std::stop_token& stop) {
  name_places(scene);
  check_run(scene);
  Simulation s = build_checked(std::move(scene));
  make_ready(s);
  try {
    const Backend backend = choose_backend(s);
    if (const std::string lost = not_as_asked(s, backend); !lost.empty()) s.warnings.add("backend", lost);
    ThreadPool pool(s.scene.solver.threads);
    RunStates states(s, look, stop);
    return outcome_of(s, run_simulation(s, backend, pool, states));
  } catch (const std::exception& e) {
    if (is_of_device(e)) throw BackendError(e.what());
    throw;
  }
}

}  // namespace fascia
