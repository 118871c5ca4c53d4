#include "app/explain/explain.hpp"

#include "app/compare/arrays.hpp"
#include "app/explain/changes.hpp"
#include "app/explain/profile.hpp"
#include "app/explain/promise.hpp"
#include "app/explain/report.hpp"
#include "app/explain/suggestions.hpp"
#include "app/explain/turns.hpp"
#include "app/reader/parse.hpp"
#include "app/results/run_text.hpp"
#include "app/run/interruption.hpp"
#include "app/run/load_scene.hpp"
#include "app/run/messages.hpp"
#include "app/run/process_memory.hpp"
#include "app/run/run_scene.hpp"
#include "app/run/temporary_folder.hpp"
#include "app/study/machine_load.hpp"
#include "app/study/tables.hpp"
#include "core/base/clock.hpp"
#include "core/base/errors.hpp"
#include "core/base/processors.hpp"
#include "io/directory_lock.hpp"
#include "io/files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// From here on two runs in turns do [s].
constexpr double kLong = 10;
/// This part of the time limit is for one run of each change; the rest measures what is worth it in turns.
constexpr double kFirstPart = 0.6;
constexpr const char* kFile = "explain.json";

/// A directory for the runs: the user's, which is new, empty or of an explanation, or one that goes at the end.
class Workplace {
 public:
  explicit Workplace(const std::optional<fs::path>& chosen) {
    std::error_code none;
    if (!chosen) {
      path_ = passing_.emplace("fascia-explain").path();
      return;
    }
    path_ = *chosen;
    if (fs::exists(path_, none) && !fs::is_directory(path_, none))
      throw FileError(fmt::format("{}: is no directory", path_.string()));
    if (fs::exists(path_, none) && !fs::is_empty(path_, none) && !fs::exists(path_ / kFile, none))
      throw FileError(fmt::format("{}: holds something else than an explanation; name another directory (--output)",
                                  path_.string()));
    io::make_directories(path_);
    lock_ = std::make_unique<io::DirectoryLock>(path_);
    io::replace_file(path_ / kFile, "{ \"fascia_explain\": 1, \"interrupted\": true }\n");
  }
  ~Workplace() {
    std::error_code none;
    for (const char* run : {"variant", "turn"}) fs::remove_all(path_ / run, none);
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  const fs::path& path() const { return path_; }
  bool kept() const { return !passing_; }

 private:
  std::optional<TemporaryFolder> passing_;
  fs::path path_;
  std::unique_ptr<io::DirectoryLock> lock_;
};

class Explainer {
 public:
  explicit Explainer(const ExplainOptions& options) : options_(options) {
    e_.quick = options.quick;
    e_.limit = options.change;
    e_.overrides = options.overrides;
    e_.scene = parse_scene_file(options.scene, e_.overrides);
    if (e_.scene.output.picture) e_.overrides.emplace_back("output.picture=");
    if (e_.scene.solver.budget)
      e_.overrides.emplace_back("solver.budget=\"none\"");  // else all runs would take as long
    add_probes();
    e_.scene = parse_scene_file(options.scene, e_.overrides);
    const double program = peak_memory();
    e_.bodies = profile_of(build_within_memory(e_.scene));
    memory_program_ = program;
    memory_built_ = peak_memory();
  }

  int run() {
    work_ = std::make_unique<Workplace>(options_.output);
    run_base();
    if (stopped()) return 128 + stop_.signal();
    if (!e_.base.converged())
      return say("{}: {}: {}; nothing can be compared with it\n", options_.scene.string(), e_.base.status,
                 e_.base.reason),
             e_.base.exit_status;
    for (Variant& v : variants_of(e_.scene, facts())) e_.parts.emplace_back().variant = std::move(v);
    estimate(e_);
    if (!e_.quick) run_parts();
    suggest();
    share_out(e_);
    finish();
    return e_.interrupted ? 128 + stop_.signal() : kDone;
  }

 private:
  bool stopped() { return stop_.requested(); }

  /// Without probes there would be nothing to compare.
  void add_probes() {
    if (!e_.scene.probes.empty()) return;
    if (e_.scene.solver.kind == SolverKind::modes) {
      e_.overrides.emplace_back("probes.explain={ quantity = \"frequency\" }");
    } else {
      for (const Body& body : e_.scene.bodies)
        if (!is_carrier(body))
          e_.overrides.push_back(
              fmt::format("probes.explain_{0}={{ body = \"{0}\", quantity = \"mean_displacement\" }}", body.name));
    }
    e_.notes.emplace_back("The scene has no probes: the mean displacements of its bodies are compared.");
  }

  ChildRun child(const char* directory, const std::vector<std::string>& changes) const {
    ChildRun run;
    run.scene = options_.scene;
    run.overrides = e_.overrides;
    run.overrides.insert(run.overrides.end(), changes.begin(), changes.end());
    run.output = work_->path() / directory;
    return run;
  }

  void run_base() {
    tell("the scene as it is");
    const auto stop = [this] { return stopped(); };
    const ChildRun run = child("base", {});
    std::error_code none;
    fs::remove_all(run.output, none);  // of an earlier explanation
    const std::optional<RunRecord> record =
        record_run(run, "base", !options_.quick, options_.repeat > 1 ? 1 : 0, options_.repeat, stop);
    if (!record) return;
    e_.base = *record;
    if (!record->converged()) return;
    e_.stages = stages_of(read_summary(run.output), e_.base, memory_program_, memory_built_);
    look_at_bodies(run.output);
    probes_ = std::make_unique<VariantProbes>(e_.scene, e_.base, run.output);
    turns_ = std::make_unique<Turns>(child("turn", {}), child("variant", {}), e_.base, stop);
  }

  /// How the bodies move, from a run that saves what tells it.
  void look_at_bodies(const fs::path& base) {
    if (e_.scene.solver.kind == SolverKind::modes) return;
    const std::vector<std::string>& fields = e_.scene.output.fields;
    fs::path directory = base;
    if (std::find(fields.begin(), fields.end(), "strain") == fields.end()) {
      const ChildRun run = child("variant", {"output.fields=[\"strain\"]"});
      run_child(run, [this] { return stopped(); });
      directory = run.output;
    }
    if (stopped()) return;
    const auto motions = body_motions(directory / (e_.scene.path.stem().string() + ".pvd"));
    for (BodyProfile& b : e_.bodies)
      if (const auto found = motions.find(b.name); found != motions.end()) b.motion = found->second;
  }

  RunFacts facts() const {
    RunFacts facts;
    facts.iterative = e_.base.linear > 0;
    facts.backend = e_.base.backend;
    facts.threads = e_.base.threads;
    facts.processors = available_processors();
    for (const BodyProfile& b : e_.bodies) facts.body_mass[b.name] = b.mass;
    return facts;
  }

  double seconds() const { return seconds_since(started_); }
  /// Something that takes these seconds ends in time.
  bool in_time(double more) const { return !(options_.time_limit > 0) || seconds() + more < options_.time_limit; }

  /// Each change once; the most promising first, as there may be no time for all.
  void run_parts() {
    const std::vector<Part*> parts = by_promise(e_);
    const double start = seconds(), limit = kFirstPart * options_.time_limit;
    std::vector<std::string> late;
    for (std::size_t i = 0; i < parts.size() && !stopped(); ++i) {
      if (limit > 0 && seconds() > limit) {
        late.push_back(label_of(parts[i]->variant));
        continue;
      }
      double left = i > 0 ? (seconds() - start) / static_cast<double>(i) * static_cast<double>(parts.size() - i) : 0;
      if (limit > 0) left = std::min(left, limit - seconds());
      tell("{} of {}{}: {}", i + 1, parts.size(), i > 0 ? fmt::format(", about {} left", seconds_text(left)) : "",
           label_of(parts[i]->variant));
      keep(*parts[i], turns_->once(parts[i]->variant.overrides));
    }
    e_.base.repeats = turns_->count();
    e_.base.solve = turns_->solve();
    e_.base.setup = turns_->setup();
    for (Part& part : e_.parts)
      if (part.measured()) part.solve = widened(part.solve, turns_->time());
    if (!late.empty())
      e_.notes.push_back(fmt::format("No time was left within {:g} s (--time-limit) for what promised least: {}.",
                                     options_.time_limit, fmt::join(late, "; ")));
  }

  void keep(Part& part, Timed timed) {
    part.record = std::move(timed.record);
    if (!part.measured()) return;
    part.solve = timed.solve;
    part.setup = timed.setup;
    part.memory = e_.base.memory > 0 ? part.record->memory / e_.base.memory : 1;
    part.changes = probes_->changes(*part.record, work_->path() / "variant");
  }

  int turns() const { return e_.base.wall > kLong ? std::min(2, options_.repeat) : options_.repeat; }

  /// Each change that seems to gain is measured in turns with the scene as it is: of many changes some seem to gain by
  /// chance.
  void suggest() {
    std::vector<const Part*> chosen;
    std::vector<std::string> late;
    for (Part* part : worth_suggesting(e_)) {
      Ratio solve{1 - part->estimated_gain, 1 - part->estimated_gain, 1 - part->estimated_gain};
      if (!e_.quick) {
        if (stopped()) break;
        if (!in_time(2 * e_.base.wall * turns())) {
          late.push_back(label_of(part->variant));
          continue;
        }
        tell("in turns: {}", label_of(part->variant));
        Timed again = turns_->several(part->variant.overrides, turns());
        if (stopped()) break;
        keep(*part, std::move(again));
        solve = part->solve;
        if (!is_worth(e_, *part)) {
          e_.notes.push_back(fmt::format("{}: gains nothing beyond the spread.", label_of(part->variant)));
          continue;
        }
      }
      e_.suggestions.push_back(suggestion_of(e_, *part, solve));
      chosen.push_back(part);
    }
    if (!late.empty())
      e_.notes.push_back(
          fmt::format("May gain, but no time was left to measure it in turns: {}.", fmt::join(late, "; ")));
    std::vector<std::size_t> order(chosen.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return e_.suggestions[a].solve.median < e_.suggestions[b].solve.median;
    });
    std::vector<Suggestion> sorted;
    std::vector<const Part*> parts;
    for (const std::size_t i : order) {
      sorted.push_back(std::move(e_.suggestions[i]));
      parts.push_back(chosen[i]);
    }
    e_.suggestions = std::move(sorted);
    if (!e_.quick && !stopped()) try_together(parts);
  }

  void try_together(const std::vector<const Part*>& parts) {
    const std::vector<std::string> changes = combined(e_, parts);
    if (changes.empty()) return;
    tell("all suggestions together");
    Part all;
    keep(all, turns_->several(changes, turns()));
    if (stopped()) return;
    if (!all.measured()) {
      e_.notes.emplace_back("All suggestions together do not converge.");
      return;
    }
    Suggestion s;
    s.overrides = changes;
    s.solve = all.solve;
    s.text = "Together " + gain_text(e_, all, s.solve, false);
    if (const ProbeChange* largest = all.largest_change()) {
      s.change = *largest;
      s.text += ", and " + change_text(e_, *largest);
    }
    s.text += ".";
    e_.together = std::move(s);
  }

  void finish() {
    e_.interrupted = stopped();
    e_.seconds = seconds();
    e_.turns = turns();
    const double others = turns_->others();
    if (others > kBusy)
      e_.notes.push_back(fmt::format(
          "The machine was busy: others took up to {:.0f} % of its processors' time, and times are worth less.",
          100 * others));
    const std::string json = json_text(json_of(e_)) + "\n";
    if (work_->kept()) io::replace_file(work_->path() / kFile, json);
    fmt::print("{}", options_.json ? json : text_of(e_));
  }

  template <class... Args>
  void tell(fmt::format_string<Args...> text, Args&&... args) const {
    if (!options_.quiet) say("explain: {}\n", fmt::format(text, std::forward<Args>(args)...));
  }

  Interruption stop_;
  const ExplainOptions& options_;
  Explanation e_;
  double memory_program_ = 0, memory_built_ = 0;  ///< peaks [bytes]
  Clock::time_point started_ = Clock::now();
  std::unique_ptr<Workplace> work_;
  std::unique_ptr<VariantProbes> probes_;
  std::unique_ptr<Turns> turns_;
};

}  // namespace

int explain_scene(const ExplainOptions& options) { return Explainer(options).run(); }

}  // namespace fascia::app
