#include "fascia/run/run_simulation.hpp"

#include "assembly/actions/actions.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "core/base/clock.hpp"
#include "core/base/errors.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "core/run/path_following.hpp"
#include "core/solver/mechanical_system.hpp"
#include "fascia/run/gpu_run.hpp"
#include "fascia/run/result_warnings.hpp"
#include "fascia/run/run_modes.hpp"
#include "fascia/run/saved_steps.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

namespace fascia {

namespace {

PathSettings path_of(const Simulation& s) {
  const Solver& solver = s.scene.solver;
  const bool arc = solver.control == StaticControl::arc_length;
  return {arc ? PathControl::arc_length : PathControl::displacement, solver.load_steps, solver.max_steps, s.controlled};
}

/// A run of steps that goes on: its state, and which states were shown.
class Steps {
 public:
  Steps(const Simulation& s, Backend backend, ThreadPool& pool, RunListener& listener)
      : s_(s),
        solver_(s.scene.solver),
        pool_(pool),
        listener_(listener),
        settings_(settings_of(s.scene.solver)),
        parts_(needed_parts(s)),
        rule_(s.scene.output, statics()),
        snaps_(s),
        time_step_(s.scene.solver.time_step) {
    const Clock::time_point start = Clock::now();
    end_.warnings = Warnings(s.scene.silenced);
    end_.backend = backend;
    end_.state = s.initial;
    settings_.iterating = [this](const IterationInfo& iteration) { listener_.iterating(iteration); };
    settings_.stops = [this] { return listener_.leaves_step(); };
    if (backend == Backend::cpu) system();
    end_.setup_seconds = seconds_since(start);
  }

  RunEnd take() {
    listener_.begins();
    const Clock::time_point start = Clock::now();
    const double processor = fascia::processor_seconds();
    if (path())
      end_.report = run_path(system(), end_.state, factors_, settings_, path_of(s_), observer());
    else if (statics())
      take_statics();
    else if (solver_.kind == SolverKind::central_differences)
      take_explicit();
    else
      take_implicit();
    end_.solve_seconds = seconds_since(start) - end_.output_seconds;
    end_.processor_seconds = fascia::processor_seconds() - processor - output_processor_;
    tell_choice();
    show_the_end();
    save_the_last();
    judge();
    return std::move(end_);
  }

 private:
  bool statics() const { return solver_.kind == SolverKind::statics; }
  bool path() const { return solver_.control != StaticControl::load; }
  bool goes_on() { return !listener_.stops() && not_shown_.empty(); }

  /// The processor's. A run on a GPU has none but where it is asked for what the GPU does not say.
  MechanicalSystem& system() {
    if (!of_processor_) of_processor_.emplace(s_.model, pool_, settings_);
    return *of_processor_;
  }

  StepObserver observer() {
    return [this](const StepInfo& step, const State& at, MechanicalSystem& there) {
      SystemStep reached(there, at);
      return watch(step, reached);
    };
  }

  /// Has a GPU take the steps, and says that it did.
  bool on_gpu(const gpu::DeviceObserver& look, const std::function<bool(const StepInfo&)>& observed = {}) {
    if (end_.backend != Backend::cuda) return false;
    const auto warn = [this](const std::string& text) {
      end_.warnings.add("backend", text);
      listener_.warned(end_.warnings);
    };
    const std::optional<GpuRun> run = run_on_gpu(s_, end_.state, factors_, settings_, warn, look, observed);
    if (!run) {
      end_.backend = Backend::cpu;
      return false;
    }
    end_.report = run->report;
    end_.gpus = run->gpus;
    return true;
  }
  gpu::DeviceObserver watcher() {
    return [this](const StepInfo& step, ReachedStep& reached) { return watch(step, reached); };
  }

  void take_statics() {
    if (!on_gpu(watcher()))
      end_.report = run_statics(system(), end_.state, factors_, settings_, {solver_.load_steps}, observer());
  }
  void take_implicit() {
    if (!on_gpu(watcher()))
      end_.report = run_implicit(system(), end_.state, factors_, settings_, dynamics_of(solver_), observer());
  }
  void take_explicit() {
    save_where_it_stands(0);
    if (!goes_on()) {
      end_.report.status = RunStatus::interrupted;
      end_.report.time = end_.state.time;
      return;
    }
    const auto observed = [this](const StepInfo& step) {
      time_step_ = step.time_step;
      listener_.stepped(step);
      return rule_.save(step) || listener_.stops();
    };
    const auto keep = [this](const StepInfo& step, ReachedStep& reached) {
      rule_.note(step);
      save(step.time, step.step, reached, true);
      end_.stabilization = reached.energy().stabilization;
      return goes_on();
    };
    if (on_gpu(keep, observed)) return;
    end_.report = run_explicit(system(), end_.state, factors_, explicit_of(s_.scene, observed),
                               [&](const StepInfo& step, const State& at, MechanicalSystem& there) {
                                 SystemStep reached(there, at);
                                 return keep(step, reached);
                               });
  }

  /// Watches all steps, and saves some.
  bool watch(const StepInfo& step, ReachedStep& reached) {
    if (step.step == 0) {
      if (saved_time_ < 0) save(0, 0, reached, true);
      return goes_on();
    }
    listener_.stepped(step);
    const bool due = rule_.save(step);
    rule_.note(step);
    if (step.progress >= 1 && end_.backend == Backend::cpu)
      wait_for_the_end(step, reached);
    else if (due || statics())
      save(step.time, step.step, reached, due);
    end_.stabilization = reached.energy().stabilization;
    if (statics() && !path()) snaps_.look(step.time, reached.energy().elastic);
    return goes_on();
  }

  void save(double time, int step, ReachedStep& reached, bool fields) {
    timed_output([&] {
      if (std::optional<ShownStep> read = look_at(time, step, reached)) show(*read, fields);
    });
  }

  /// A step with the values of its probes.
  struct ShownStep {
    double time;
    int step;
    ProbedState at;
    ProbeValues values;
  };
  /// Reads a step; none where it cannot be shown.
  std::optional<ShownStep> look_at(double time, int step, ReachedStep& reached) {
    try {
      acting_is_known_ = false;
      const State& at = reached.state();
      reached.read(parts_, end_.acting);
      acting_is_known_ = true;
      const ProbedState probed{&at, &end_.acting, 0, time_step_};
      return ShownStep{time, step, probed, probe_values(s_, probed)};  // before a file: all of a state, or nothing
    } catch (const StateError& e) {
      not_shown_ = e.what();
      return std::nullopt;
    }
  }
  void show(const ShownStep& shown, bool fields) {
    try {
      if (fields) listener_.save(path() ? shown.step : shown.time, *shown.at.state);
    } catch (const StateError& e) {
      not_shown_ = e.what();
      return;
    }
    listener_.show(shown.time, shown.at, shown.values);  // what this throws is the listener's own
    if (fields) saved_time_ = shown.time;
    if (fields) saved_step_ = shown.step;
  }
  template <class Act>
  void timed_output(const Act& act) {
    const Clock::time_point start = Clock::now();
    const double processor = fascia::processor_seconds();
    act();
    end_.output_seconds += seconds_since(start);
    output_processor_ += fascia::processor_seconds() - processor;
  }

  /// Keeps the last step until the run is over: a matrix, its factor and levels need not lie beside what writes a
  /// state.
  void wait_for_the_end(const StepInfo& step, ReachedStep& reached) {
    timed_output([&] { last_ = look_at(step.time, step.step, reached); });
  }
  void show_the_end() {
    if (!last_) return;
    of_processor_.reset();
    timed_output([&] { show(*last_, true); });
    listener_.stops();  // as after each state that was shown
  }

  /// No step led there: the start of explicit runs, and where a run broke off.
  void save_where_it_stands(int step) {
    if (parts_.any()) system().set_factors(factors_(end_.state.time));
    if (parts_.any()) system().look_at(end_.state, solver_.time_step);
    StandingState standing(of_processor_, end_.state);
    save(end_.state.time, step, standing, true);
    if (end_.backend == Backend::cuda) of_processor_.reset();
  }

  void tell_choice() {
    const bool solved =
        end_.backend == Backend::cpu && end_.report.newton_iterations > 0 && !path() && s_.model.free_dof_count() > 0;
    if (!solved) return listener_.ended(nullptr);
    const SolverChoice choice = system().linear().choice();
    listener_.ended(&choice);
  }

  /// Saves the state where a run failed, for what was computed up to there is a result too.
  void save_the_last() {
    RunReport& run = end_.report;
    if (!not_shown_.empty()) {
      run.status = RunStatus::diverged;
      run.message = fmt::format("{} {:.6g}: {}; the results end before it", statics() ? "load factor" : "t =", run.time,
                                not_shown_);
    }
    const bool unsaved = path() ? saved_step_ != run.steps || saved_step_ == 0 : saved_time_ != end_.state.time;
    if (run.status == RunStatus::converged || !unsaved || !not_shown_.empty()) return;
    if (!statics() || run.steps == 0 || !acting_is_known_) return save_where_it_stands(run.steps);
    of_processor_.reset();
    try {
      listener_.save(path() ? run.steps : end_.state.time, end_.state);
    } catch (const StateError& e) {
      not_shown_ = e.what();
    }
  }

  void judge() {
    RunReport& run = end_.report;
    const bool ended = run.status == RunStatus::converged;
    add_result_warnings(s_, end_.state, run, end_.warnings);
    end_.failed = !ended || run.status == RunStatus::unstable || run.status == RunStatus::inverted;
    end_.shown = not_shown_.empty();
    if (!snaps_.warning().empty()) {
      run.doubts.push_back(snaps_.warning());
      end_.warnings.add("snap", snaps_.warning());
    }
    if (run.status == RunStatus::interrupted) run.message = fmt::format("interrupted at {:.6g}", run.time);
  }

  const Simulation& s_;
  const Solver& solver_;
  ThreadPool& pool_;
  RunListener& listener_;
  const FactorFunction factors_ = [this](double t) { return s_.factors(t); };
  SolverSettings settings_;
  std::optional<MechanicalSystem> of_processor_;
  ReachedParts parts_;
  SaveRule rule_;
  SnapWatch snaps_;
  RunEnd end_;
  std::optional<ShownStep> last_;  ///< that waits for the end
  bool acting_is_known_ = false;   ///< nothing broke off in the midst of it
  double time_step_, saved_time_ = -1, output_processor_ = 0;
  int saved_step_ = 0;
  std::string not_shown_;  ///< why the last state is in no result
};

}  // namespace

void make_ready(Simulation& s) {
  add_imperfection(s);
  if (s.scene.solver.kind != SolverKind::central_differences) return;
  ThreadPool pool(s.scene.solver.threads);
  MechanicalSystem system(s.model, pool, settings_of(s.scene.solver));
  settle_time_step(s, system);
}

RunEnd run_simulation(const Simulation& s, Backend backend, ThreadPool& pool, RunListener& listener) {
  if (s.scene.solver.kind == SolverKind::modes) return run_modes(s, pool, listener);
  return Steps(s, backend, pool, listener).take();
}

}  // namespace fascia
