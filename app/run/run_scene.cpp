#include "app/run/run_scene.hpp"

#include "app/diagnosis/failure.hpp"
#include "app/estimate/error_estimate.hpp"
#include "app/results/coupling_report.hpp"
#include "app/results/picture.hpp"
#include "app/results/result_size.hpp"
#include "app/results/result_warnings.hpp"
#include "app/results/results.hpp"
#include "app/results/run_result.hpp"
#include "app/results/run_text.hpp"
#include "app/results/tell_warnings.hpp"
#include "app/run/gpu_run.hpp"
#include "app/run/interruption.hpp"
#include "app/run/load_scene.hpp"
#include "app/run/memory.hpp"
#include "app/run/messages.hpp"
#include "app/run/mode_warnings.hpp"
#include "app/run/progress.hpp"
#include "app/run/saved_steps.hpp"
#include "app/run/solver_choice.hpp"
#include "app/tools.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "assembly/specification/readable.hpp"
#include "core/base/clock.hpp"
#include "core/base/errors.hpp"
#include "core/math/rotation.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "core/run/modes.hpp"
#include "fascia/choose_backend.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <optional>

namespace fascia::app {

namespace {

PathSettings path_of(const Simulation& s) {
  const Solver& solver = s.scene.solver;
  const bool arc = solver.control == StaticControl::arc_length;
  return {arc ? PathControl::arc_length : PathControl::displacement, solver.load_steps, solver.max_steps, s.controlled};
}

struct Outcome {
  RunReport run;
  Backend backend = Backend::cpu;  ///< that took the steps
  int gpus = 0;
  bool failed = false;  ///< not only steps that were accepted as they were
  Warnings warnings;
  RunTimes times;
  std::vector<nlohmann::json> probes;
  std::vector<double> frequencies;  ///< of modes [1/s]
  double stabilization = 0;
  std::vector<FluidState> fluids;
  CouplingReports couplings;
  nlohmann::ordered_json failure;  ///< null: none
};

Outcome simulate(const Simulation& s, Backend backend, ThreadPool& pool, RunResult& files, const RunOptions& options,
                 Interruption& stop, ErrorEstimate* estimate) {
  Outcome out;
  out.warnings = Warnings(s.scene.silenced);
  out.backend = backend;
  const Clock::time_point setup = Clock::now();
  SolverSettings settings = settings_of(s.scene.solver);
  const bool statics = s.scene.solver.kind == SolverKind::statics;
  // A run on a GPU has none but where it is asked for what the GPU does not say.
  std::optional<MechanicalSystem> of_processor;
  const auto system = [&]() -> MechanicalSystem& {
    if (!of_processor) of_processor.emplace(s.model, pool, settings);
    return *of_processor;
  };
  if (backend == Backend::cpu) system();
  const ReachedParts parts = needed_parts(s);
  ReachedForces acting;          // at the state that was shown last
  bool acting_is_known = false;  // nothing broke off in the midst of it
  State state = s.initial;
  out.times.setup = seconds_since(setup);
  Progress progress(options.quiet || options.json, options.verbose, statics);
  settings.iterating = [&](const IterationInfo& iteration) { progress.update(iteration); };
  SaveRule rule(s.scene.output, statics);
  const FactorFunction factors = [&](double t) { return s.factors(t); };
  const bool path = s.scene.solver.control != StaticControl::load;
  double output_seconds = 0, output_processor = 0, saved_time = -1, time_step = s.scene.solver.time_step;
  int saved_step = 0;
  SnapWatch snaps(s);
  std::string not_shown;  // why the last state is in no result
  const auto save = [&](double time, int step, ReachedStep& reached, bool fields) {
    const Clock::time_point start = Clock::now();
    const double processor = processor_seconds();
    try {
      acting_is_known = false;
      const State& at = reached.state();
      reached.read(parts, acting);
      acting_is_known = true;
      if (fields) files.add_state(path ? step : time, at);
      files.add_probes(time, {&at, &acting, 0, time_step});
      if (estimate) estimate->add(time, at);
      if (fields) saved_time = time;
      if (fields) saved_step = step;
    } catch (const StateError& e) {
      not_shown = e.what();
    }
    output_seconds += seconds_since(start);
    output_processor += processor_seconds() - processor;
  };
  // No step led there: the start of explicit runs, and where a run broke off.
  const auto save_where_it_stands = [&](int step) {
    if (parts.any()) system().set_factors(factors(state.time));
    if (parts.any()) system().look_at(state, s.scene.solver.time_step);
    StandingState standing(of_processor, state);
    save(state.time, step, standing, true);
    if (out.backend == Backend::cuda) of_processor.reset();
  };
  // Watches all steps, and saves some.
  const auto watch = [&](const StepInfo& step, ReachedStep& reached) {
    if (step.step == 0) {
      if (saved_time < 0) save(0, 0, reached, true);
      return !stop.requested() && not_shown.empty();
    }
    out.times.steps.add(step.seconds);
    progress.update(step);
    files.note(step);
    const bool due = rule.save(step);
    rule.note(step);
    if (due || statics) save(step.time, step.step, reached, due);
    out.stabilization = reached.energy().stabilization;
    if (statics && !path) snaps.look(step.time, reached.energy().elastic);
    return !stop.requested() && not_shown.empty();
  };
  const auto observe = [&](const StepInfo& step, const State& at, MechanicalSystem& there) {
    SystemStep reached(there, at);
    return watch(step, reached);
  };
  // Whether the GPU did it.
  const auto on_gpu = [&](const gpu::DeviceObserver& look, const std::function<bool(const StepInfo&)>& observed = {}) {
    if (out.backend != Backend::cuda) return false;
    const std::optional<GpuRun> run = run_on_gpu(s, state, factors, settings, out.warnings, look, observed);
    if (!run) {
      out.backend = Backend::cpu;
      return false;
    }
    out.run = run->report;
    out.gpus = run->gpus;
    return true;
  };
  const Clock::time_point start = Clock::now();
  const double processor = processor_seconds();
  if (path) {
    out.run = run_path(system(), state, factors, settings, path_of(s), observe);
  } else if (statics) {
    if (!on_gpu(watch)) out.run = run_statics(system(), state, factors, settings, {s.scene.solver.load_steps}, observe);
  } else {
    if (s.scene.solver.kind == SolverKind::central_differences) {
      save_where_it_stands(0);
      const auto observed = [&](const StepInfo& step) {
        out.times.steps.add(step.seconds);
        time_step = step.time_step;
        progress.update(step);
        files.note(step);
        return rule.save(step) || stop.requested();
      };
      const auto keep = [&](const StepInfo& step, ReachedStep& reached) {
        rule.note(step);
        save(step.time, step.step, reached, true);
        out.stabilization = reached.energy().stabilization;
        return !stop.requested() && not_shown.empty();
      };
      if (!on_gpu(keep, observed))
        out.run = run_explicit(system(), state, factors, explicit_of(s.scene, observed),
                               [&](const StepInfo& step, const State& at, MechanicalSystem& there) {
                                 SystemStep reached(there, at);
                                 return keep(step, reached);
                               });
    } else if (!on_gpu(watch)) {
      out.run = run_implicit(system(), state, factors, settings, dynamics_of(s.scene.solver), observe);
    }
  }
  progress.finish();
  out.times.solve = seconds_since(start) - output_seconds;
  out.times.processor = processor_seconds() - processor - output_processor;
  if (options.verbose && out.backend == Backend::cpu && out.run.newton_iterations > 0 && !path &&
      s.model.free_dof_count() > 0)
    say("{}\n", told(system().linear().choice()));
  if (!not_shown.empty()) {
    out.run.status = RunStatus::diverged;
    out.run.message = fmt::format("{} {:.6g}: {}; the results end before it",
                                  statics ? "load factor" : "t =", out.run.time, not_shown);
  }
  // What was computed up to a failure is a result too.
  const bool unsaved = path ? saved_step != out.run.steps || saved_step == 0 : saved_time != state.time;
  if (out.run.status != RunStatus::converged && unsaved && not_shown.empty()) {
    if (statics && out.run.steps > 0 && acting_is_known) {
      files.add_state(path ? out.run.steps : state.time, state);
    } else {
      save_where_it_stands(out.run.steps);
    }
  }
  const bool ended = out.run.status == RunStatus::converged;
  add_result_warnings(s, state, out.run, out.warnings);
  out.failed = !ended || out.run.status == RunStatus::unstable || out.run.status == RunStatus::inverted;
  if (out.failed) out.failure = keep_failed(s, state, !not_shown.empty(), out.run, files);
  out.couplings = coupling_report(s, acting, state);
  for (std::size_t f = 0; f < s.fluids.size(); ++f) out.fluids.push_back(fluid_state(s, static_cast<int>(f), state));
  if (!snaps.warning().empty()) {
    out.run.doubts.push_back(snaps.warning());
    out.warnings.add("snap", snaps.warning());
  }
  out.times.output = output_seconds;
  if (out.run.status == RunStatus::interrupted) out.run.message = fmt::format("interrupted at {:.6g}", out.run.time);
  for (std::size_t i = 0; i < s.probes.size(); ++i) out.probes.push_back(probe_json(s.probes[i], files.last_values(i)));
  return out;
}

Outcome find_modes(const Simulation& s, ThreadPool& pool, RunResult& files) {
  Outcome out;
  out.warnings = Warnings(s.scene.silenced);
  const Clock::time_point start = Clock::now();
  const double processor = processor_seconds();
  const Modes modes = natural_modes(s.model, pool, s.scene.solver.modes);
  out.times.solve = seconds_since(start);
  out.times.processor = processor_seconds() - processor;
  out.frequencies = modes.frequency;
  out.run.steps = static_cast<int>(modes.frequency.size());
  out.run.linear_iterations = modes.iterations;
  if (!modes.converged) {
    out.run.status = RunStatus::not_converged;
    out.run.message = "the subspace iteration did not settle; ask for fewer modes";
  }
  warn_of_modes(modes, s, out.warnings);
  std::vector<nlohmann::json> frequencies(s.probes.size(), nlohmann::json::array());
  double size = 0;
  for (const SimulatedBody& b : s.bodies) size = std::max(size, b.body->size());
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
                             : frame_variation(dofs.kind(i), d + 3, {}) * scale;
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

int exit_status(RunStatus status, int signal) {
  if (status == RunStatus::interrupted) return 128 + signal;
  return status == RunStatus::converged ? kDone : kNotConverged;
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
    return s.scene.solver.kind == SolverKind::modes ? find_modes(s, pool, files)
                                                    : simulate(s, backend, pool, files, options, stop, estimate);
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
  out.times.setup += setup;
  tell(out.warnings, options.scene);
  s.warnings.add(out.warnings);
  nlohmann::ordered_json j = summary(s, out.backend, out.gpus, out.run, out.times, pool.size(), out.probes,
                                     out.stabilization, out.fluids, out.couplings, files.provenance());
  if (!out.failure.is_null()) j["failure"] = out.failure;
  if (options.complete) options.complete(j);
  finish(s, files, j);
  if (s.scene.output.picture && out.run.status != RunStatus::interrupted)
    make_picture(s, files.path(), s.scene.solver.kind == SolverKind::modes ? out.frequencies : files.times(),
                 out.run.status);
  const bool as_asked = out.run.steps_at_limit > 0 && !out.failed;  // steps were accepted as they were
  const bool done = out.run.status == RunStatus::converged || as_asked;
  const bool estimated = !estimate || (done && add_estimate(s, options, *estimate, files, stop, j));
  if (options.json)
    fmt::print("{}\n", json_text(j));
  else if (!options.quiet)
    print_summary(s, j, files.shown());
  if (out.run.status != RunStatus::converged) say("{}: {}\n", options.scene.string(), out.run.message);
  if (done && !estimated) return 128 + stop.signal();
  if (as_asked) return kDone;
  return exit_status(out.run.status, stop.signal());
}

}  // namespace fascia::app
