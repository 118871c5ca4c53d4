#include "app/explain/explain.hpp"

#include "app/compare/arrays.hpp"
#include "app/explain/changes.hpp"
#include "app/explain/profile.hpp"
#include "app/explain/report.hpp"
#include "app/explain/suggestions.hpp"
#include "app/explain/turns.hpp"
#include "app/interruption.hpp"
#include "app/messages.hpp"
#include "app/process_memory.hpp"
#include "app/run_scene.hpp"
#include "app/run_text.hpp"
#include "app/scene/parse.hpp"
#include "app/study/machine_load.hpp"
#include "app/study/tables.hpp"
#include "core/model/errors.hpp"
#include "core/solver/clock.hpp"
#include "io/directory_lock.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <thread>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// From here on two runs in turns do [s].
constexpr double kLong = 20;
constexpr const char* kFile = "explain.json";

/// A directory for the runs: the user's, which is new, empty or of an explanation, or one that goes at the end.
class Workplace {
 public:
  explicit Workplace(const std::optional<fs::path>& chosen) : kept_(chosen.has_value()) {
    std::error_code none;
    if (!kept_) {
      std::string name = (fs::temp_directory_path() / "fascia-explain-XXXXXX").string();
      if (mkdtemp(name.data()) == nullptr) throw FileError(fmt::format("{}: cannot be made", name));
      path_ = name;
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
    if (!kept_) fs::remove_all(path_, none);
    for (const char* passing : {"variant", "turn"}) fs::remove_all(path_ / passing, none);
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  const fs::path& path() const { return path_; }
  bool kept() const { return kept_; }

 private:
  bool kept_;
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
    add_probes();
    e_.scene = parse_scene_file(options.scene, e_.overrides);
    const double program = peak_memory();
    e_.bodies = profile_of(build_simulation(e_.scene));
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
    if (e_.quick) {
      estimate();
    } else {
      run_parts();
    }
    share_out(e_);
    suggest();
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
    others_ = record->others;
    if (!record->converged()) return;
    e_.stages = stages_of(read_summary(run.output), e_.base, memory_program_, memory_built_);
    look_at_bodies(run.output);
    probes_ = std::make_unique<VariantProbes>(e_.scene, e_.base, run.output);
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
    facts.processors = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    for (const BodyProfile& b : e_.bodies) facts.body_mass[b.name] = b.mass;
    return facts;
  }

  void run_parts() {
    const auto all = static_cast<std::size_t>(
        std::count_if(e_.parts.begin(), e_.parts.end(), [](const Part& p) { return p.variant.refused.empty(); }));
    const Clock::time_point start = Clock::now();
    std::size_t done = 0;
    for (Part& part : e_.parts) {
      if (stopped()) return;
      if (!part.variant.refused.empty()) continue;
      const double each = done > 0 ? seconds_since(start) / static_cast<double>(done) : 0;
      tell("{} of {}{}: {}", done + 1, all,
           done > 0 ? fmt::format(", about {} left", seconds_text(each * static_cast<double>(all - done))) : "",
           label_of(part.variant));
      run_part(part);
      ++done;
    }
  }

  void run_part(Part& part) {
    Turns turns = in_turns(part.variant.overrides);
    part.record = std::move(turns.record);
    if (!part.measured()) return;
    part.solve = turns.solve;
    part.setup = turns.setup;
    part.memory = e_.base.memory > 0 ? part.record->memory / e_.base.memory : 1;
    part.changes = probes_->changes(*part.record, work_->path() / "variant");
  }

  Turns in_turns(const std::vector<std::string>& changes) {
    const int turns = e_.base.wall > kLong ? std::min(2, options_.repeat) : options_.repeat;
    Turns result = run_in_turns(child("turn", {}), child("variant", changes), turns, [this] { return stopped(); });
    if (result.record) others_ = std::max(others_, result.record->others);
    return result;
  }

  /// Without runs: what a body's points take of the time, and what its deformation is of all displacements.
  void estimate() {
    double points = 0, displacement = 0;
    for (const BodyProfile& b : e_.bodies) {
      points += static_cast<double>(b.points);
      if (b.motion) displacement = std::max(displacement, b.motion->displacement);
    }
    for (Part& part : e_.parts) {
      const auto body = std::find_if(e_.bodies.begin(), e_.bodies.end(),
                                     [&](const BodyProfile& b) { return b.name == part.variant.body; });
      if (body == e_.bodies.end() || !(points > 0)) continue;
      const double share = static_cast<double>(body->points) / points;
      const VariantKind kind = part.variant.kind;
      if (kind == VariantKind::left_out) part.estimated_gain = share;
      if (kind == VariantKind::coarser) part.estimated_gain = share * (1 - part.variant.growth);
      if (kind != VariantKind::rigid) continue;
      part.estimated_gain = share;
      if (body->motion && displacement > 0) part.estimated_change = body->motion->deformation / displacement;
    }
  }

  void suggest() {
    std::vector<const Part*> chosen;
    for (const Part* part : worth_suggesting(e_)) {
      Ratio solve{1 - part->estimated_gain, 1 - part->estimated_gain, 1 - part->estimated_gain};
      if (!e_.quick) {
        if (stopped()) break;
        tell("once more: {}", label_of(part->variant));
        const Turns again = in_turns(part->variant.overrides);
        if (stopped()) break;
        solve = again.solve;
        if (!solve.is_less()) {  // of many changes some seem to gain by chance
          e_.notes.push_back(
              fmt::format("{}: its gain was within the spread once it was measured again.", label_of(part->variant)));
          continue;
        }
      }
      e_.suggestions.push_back(suggestion_of(e_, *part, solve));
      chosen.push_back(part);
    }
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
    Suggestion s;
    s.overrides = changes;
    Turns turns = in_turns(changes);
    if (stopped()) return;
    all.record = std::move(turns.record);
    s.solve = turns.solve;
    if (!all.measured()) {
      e_.notes.emplace_back("All suggestions together do not converge.");
      return;
    }
    all.changes = probes_->changes(*all.record, work_->path() / "variant");
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
    if (others_ > kBusy)
      e_.notes.push_back(fmt::format(
          "The machine was busy: others took up to {:.0f} % of its processors' time, and times are worth less.",
          100 * others_));
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
  double others_ = 0;
  std::unique_ptr<Workplace> work_;
  std::unique_ptr<VariantProbes> probes_;
};

}  // namespace

int explain_scene(const ExplainOptions& options) { return Explainer(options).run(); }

}  // namespace fascia::app
