#include "app/run/run_scene.hpp"

#include "app/diagnosis/failure.hpp"
#include "app/estimate/error_estimate.hpp"
#include "app/results/picture.hpp"
#include "app/results/probes.hpp"
#include "app/results/result_size.hpp"
#include "app/results/results.hpp"
#include "app/results/run_result.hpp"
#include "app/results/run_text.hpp"
#include "app/results/tell_warnings.hpp"
#include "app/run/interruption.hpp"
#include "app/run/load_scene.hpp"
#include "app/run/memory.hpp"
#include "app/run/messages.hpp"
#include "app/run/progress.hpp"
#include "app/run/solver_choice.hpp"
#include "app/tools.hpp"
#include "assembly/specification/readable.hpp"
#include "core/base/clock.hpp"
#include "core/base/errors.hpp"
#include "fascia/choose_backend.hpp"
#include "fascia/run/run_simulation.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <optional>
#include <vector>

namespace fascia::app {

namespace {

/// Shows a run while it goes on, and writes its results as they arise.
class ShownRun final : public RunListener {
 public:
  ShownRun(const Simulation& s, RunResult& files, const RunOptions& options, Interruption& stop,
           ErrorEstimate* estimate)
      : s_(s),
        files_(files),
        options_(options),
        stop_(stop),
        estimate_(estimate),
        modes_(s.probes.size(), nlohmann::json::array()) {}

  bool stops() override { return stop_.requested(); }
  void begins() override {
    progress_.emplace(options_.quiet || options_.json, options_.verbose, s_.scene.solver.kind == SolverKind::statics);
  }
  void iterating(const IterationInfo& iteration) override { progress_->update(iteration); }
  void stepped(const StepInfo& step) override {
    steps_.add(step.seconds);
    if (s_.scene.solver.budget) budget_.add(step, *s_.scene.solver.budget);
    progress_->update(step);
    files_.note(step);
  }
  void save(double number, const State& state) override { files_.add_state(number, state); }
  void show(double time, const ProbedState& at, const ProbeValues& values) override {
    files_.add_probes(time, values, at.time_step);
    if (estimate_) estimate_->add(time, *at.state);
    if (s_.scene.solver.kind == SolverKind::modes) take_row(s_, values, modes_);
  }
  void warned(Warnings& warnings) override { tell(warnings, s_.scene.path); }
  void ended(const SolverChoice* choice) override {
    progress_->finish();
    if (options_.verbose && choice) say("{}\n", told(*choice));
  }

  const StepSeconds& steps() const { return steps_; }
  const BudgetUse& budget() const { return budget_; }
  /// Values of all probes at the end; of modes, frequencies are lists.
  std::vector<nlohmann::json> probes() const {
    if (s_.scene.solver.kind == SolverKind::modes) return modes_;
    std::vector<nlohmann::json> values;
    for (std::size_t i = 0; i < s_.probes.size(); ++i)
      values.push_back(probe_json(s_.probes[i], files_.last_values(i)));
    return values;
  }

 private:
  const Simulation& s_;
  RunResult& files_;
  const RunOptions& options_;
  Interruption& stop_;
  ErrorEstimate* estimate_;
  std::optional<Progress> progress_;  ///< from the first step on
  StepSeconds steps_;
  BudgetUse budget_;
  std::vector<nlohmann::json> modes_;
};

/// A run with what else its summary tells.
struct Outcome {
  RunEnd end;
  nlohmann::ordered_json failure;  ///< null: none
  StepSeconds steps;
  BudgetUse budget;
  std::vector<nlohmann::json> probes;
};

Outcome simulate(const Simulation& s, Backend backend, ThreadPool& pool, RunResult& files, const RunOptions& options,
                 Interruption& stop, ErrorEstimate* estimate) {
  ShownRun shown(s, files, options, stop, estimate);
  Outcome out;
  out.end = run_simulation(s, backend, pool, shown);
  const bool may_fail = out.end.failed && s.scene.solver.kind != SolverKind::modes;
  if (may_fail) out.failure = keep_failed(s, out.end.state, !out.end.shown, out.end.report, files);
  out.steps = shown.steps();
  out.budget = shown.budget();
  out.probes = shown.probes();
  return out;
}

/// Says where an error, or a signal, leaves a result.
std::string kept(const Simulation& s, bool saved) {
  return saved ? fmt::format("; {} holds what was saved before", s.scene.output.directory.string()) : "";
}

/// Writes the summary; where that cannot be done, the one of a run that ended early.
void finish(const Simulation& s, RunResult& files, const nlohmann::ordered_json& summary) {
  try {
    files.finish(summary);
  } catch (const std::exception& e) {
    files.end(RunStatus::interrupted, e.what());
    if (files.shown()) say("{}: its end could not be written{}\n", s.scene.path.string(), kept(s, true));
    throw;
  }
}

/// The run. What was saved before an error stays, with a summary that tells it.
Outcome computed(const Simulation& s, Backend backend, ThreadPool& pool, RunResult& files, const RunOptions& options,
                 Interruption& stop, ErrorEstimate* estimate) {
  const auto fail = [&](RunStatus status, const std::exception& e) {
    files.end(status, e.what());
    if (files.shown()) say("{}: it ended early{}\n", options.scene.string(), kept(s, true));
  };
  try {
    return simulate(s, backend, pool, files, options, stop, estimate);
  } catch (const StateError& e) {
    fail(RunStatus::diverged, e);
    throw;
  } catch (const std::exception& e) {
    fail(RunStatus::interrupted, e);
    throw;
  }
}

/// Runs the twins and tells the errors, in the summary too. @return  whether it was not interrupted
bool add_estimate(const Simulation& s, const RunOptions& options, ErrorEstimate& estimate, RunResult& files,
                  Interruption& stop, nlohmann::ordered_json& summary) {
  const auto tell = [&](const std::string& line) {
    if (!options.quiet && !options.json) fmt::print("{}\n", line), std::fflush(stdout);
  };
  if (!estimate.run(files.path(), summary, tell, [&] { return stop.requested(); })) {
    say("{}: interrupted before its errors were estimated\n", options.scene.string());
    return false;
  }
  finish(s, files, summary);
  return true;
}

}  // namespace

int run_scene(const RunOptions& options) {
  const Clock::time_point start = Clock::now();
  Scene scene = read_scene(options);
  if (scene.states_need()) return tools().run_need(options, scene);
  if (options.new_trials)
    throw InputError(scene.path.string() + ": states no need, so that it has no trials; leave --new-trials out");
  Interruption stop;
  Simulation s = load_scene(std::move(scene));
  const Backend backend = choose_backend(s);
  warn_of_backend(s, backend);
  check_run_memory(s, backend == Backend::cuda);
  if (may_be_large(s)) warn_of_size(s, forecast_result(s));
  if (!options.quiet && !options.json)
    for (const SimulatedBody& b : s.bodies) fmt::print("body {}: {}\n", b.name, body_text(*b.body));
  std::unique_ptr<ErrorEstimate> estimate;
  if (s.scene.output.estimate) estimate = tools().make_estimate(s);
  RunResult files(s);
  const Abandonable while_it_lives(stop, [&] {
    const bool saved = files.abandon();
    say("\n{}: interrupted within a step{}\n", options.scene.string(), kept(s, saved));
  });
  ThreadPool pool(s.scene.solver.threads);
  const double setup = seconds_since(start);
  Outcome out = computed(s, backend, pool, files, options, stop, estimate.get());
  const RunEnd& end = out.end;
  const RunReport& run = end.report;
  tell(out.end.warnings, options.scene);
  s.warnings.add(end.warnings);
  const RunTimes times{end.setup_seconds + setup, end.solve_seconds, end.output_seconds,
                       end.processor_seconds,     out.steps,         out.budget};
  nlohmann::ordered_json j = summary(s, end, times, pool.size(), out.probes, files.provenance());
  if (!out.failure.is_null()) j["failure"] = out.failure;
  if (options.complete) options.complete(j);
  finish(s, files, j);
  if (s.scene.output.picture && run.status != RunStatus::interrupted)
    make_picture(s, files.path(), s.scene.solver.kind == SolverKind::modes ? end.frequencies : files.times(),
                 run.status);
  const bool done = end.done();
  const bool estimated = !estimate || (done && add_estimate(s, options, *estimate, files, stop, j));
  if (options.json)
    fmt::print("{}\n", json_text(j));
  else if (!options.quiet)
    print_summary(s, j, files.shown());
  if (run.status != RunStatus::converged) say("{}: {}\n", options.scene.string(), run.message);
  if (done && !estimated) return 128 + stop.signal();
  if (done) return kDone;
  return run.status == RunStatus::interrupted ? 128 + stop.signal() : kNotConverged;
}

}  // namespace fascia::app
