#include "app/study/study.hpp"

#include "app/reader/parse.hpp"
#include "app/run/interruption.hpp"
#include "app/run/messages.hpp"
#include "app/run/run_scene.hpp"
#include "app/study/page.hpp"
#include "app/study/tables.hpp"
#include "core/base/clock.hpp"
#include "core/base/errors.hpp"
#include "core/base/processors.hpp"
#include "io/directory_lock.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <set>
#include <thread>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// Runs that take longer are not repeated for a picture [s].
constexpr double kLongestForPicture = 120;

/// The directory is new, empty, or a study's own: what else it may be is not written over.
void check_directory(const fs::path& directory) {
  std::error_code none;
  if (!fs::exists(directory, none)) return io::make_directories(directory);
  if (!fs::is_directory(directory, none)) throw FileError(fmt::format("{}: is no directory", directory.string()));
  if (fs::is_empty(directory, none) || fs::exists(directory / "study.json", none)) return;
  throw FileError(
      fmt::format("{}: holds something else than a study; name another directory (--output)", directory.string()));
}

/// Dimension of the largest of the bodies: 3 for solids, 2 for shells and sheets, 1 for lines.
int dimension_of(const Scene& scene) {
  int dimension = 1;
  for (const Body& body : scene.bodies) {
    const bool line = std::holds_alternative<LineDomain>(body.domain);
    const bool surface = is_shell(body) || std::holds_alternative<RectangleDomain>(body.domain) ||
                         std::holds_alternative<AnnulusDomain>(body.domain);
    dimension = std::max(dimension, line ? 1 : surface ? 2 : 3);
  }
  return dimension;
}

class StudyDriver {
 public:
  StudyDriver(Study study, const StudyOptions& options, fs::path directory)
      : options_(options), directory_(std::move(directory)), start_(Clock::now()) {
    result_.study = std::move(study);
    for (PlannedRun& plan : plan_study(result_.study)) result_.runs.push_back({std::move(plan), {}, {}, {}, {}});
    result_.questions = questions_of(result_.study);
    const Scene base = parse_scene_file(result_.study.base, result_.study.overrides);
    result_.dimension = result_.study.dimension.value_or(dimension_of(base));
    // Where steps differ in length, one of them says nothing of the whole.
    const bool by_step = is_dynamic(base.solver.kind) && !varies_steps();
    result_.cost = result_.study.cost.value_or(by_step ? StudyCost::step : StudyCost::solve);
  }

  int run() {
    check_directory(directory_);
    const io::DirectoryLock lock(directory_);
    io::replace_file(directory_ / "study.json", "{ \"fascia_study\": 1, \"interrupted\": true }\n");
    run_references();
    if (result_.study.mode == StudyMode::front)
      run_front();
    else
      run_all();
    result_.interrupted = stop_.requested();
    write();
    if (result_.interrupted) return 128 + stop_.signal();
    const bool any =
        std::any_of(result_.runs.begin(), result_.runs.end(), [](const StudyRun& r) { return r.converged(); });
    return any ? kDone : kNotConverged;
  }

 private:
  bool stopped() { return stop_.requested(); }

  bool varies_steps() const {
    for (const StudyAxis& axis : result_.study.axes)
      for (const AxisValue& value : axis.values)
        for (const std::string& change : value.overrides)
          if (change.find("time_step") != std::string::npos) return true;
    return false;
  }

  ChildRun child_of(const fs::path& scene, const PlannedRun& plan) const {
    ChildRun run;
    run.scene = scene;
    run.overrides = plan.overrides;
    run.output = directory_ / plan.directory;
    run.time_limit = result_.study.time_limit;
    return run;
  }

  /// Whether a record that was found is as good as one that would be made.
  bool is_enough(const RunRecord& record, bool timed) const {
    return !timed || !record.converged() ||
           record.repeats >= std::min(result_.study.repeat, record.wall > 20 ? 2 : result_.study.repeat);
  }

  void run_references() {
    reference_runs_.resize(result_.questions.size());
    for (std::size_t q = 0; q < reference_runs_.size() && !stopped(); ++q) {
      const Question& question = result_.questions[q];
      const StudyMeasure& measure = result_.study.measures[question.measure];
      if (measure.reference.kind != StudyReference::Kind::scene) continue;
      StudyRun& run = reference_runs_[q].emplace();
      run.plan = plan_reference(result_.study, measure, question.group);
      run.record = read_record(directory_ / run.plan.directory, run.plan.key);
      if (run.record) continue;
      tell("the reference of {} is computed", question.name);
      const fs::path& scene = measure.reference.scene.empty() ? result_.study.base : measure.reference.scene;
      run.record = record_run(child_of(scene, run.plan), run.plan.key, false, 0, 1, [this] { return stopped(); });
      if (run.record) write_record(directory_ / run.plan.directory, *run.record);
    }
  }

  /// Runs one combination, or takes it from an earlier call.
  void settle(std::size_t r) {
    StudyRun& run = result_.runs[r];
    if (!run.plan.refused.empty() || run.record) return;
    const fs::path directory = directory_ / run.plan.directory;
    const bool timed = result_.study.timed;
    std::optional<RunRecord> record = read_record(directory, run.plan.key);
    const bool found = record && is_enough(*record, timed);
    if (!found)
      record = record_run(child_of(result_.study.base, run.plan), run.plan.key, timed, result_.study.warm_up,
                          result_.study.repeat, [this] { return stopped(); });
    if (!record) return;
    if (!found) write_record(directory, *record);
    const std::lock_guard guard(telling_);
    run.record = std::move(record);
    note(run, found);
  }

  void run_all() {
    const int parallel = result_.study.timed ? 1 : options_.jobs.value_or(available_processors());
    std::atomic<std::size_t> next{0};
    std::exception_ptr error;
    const auto work = [&] {
      for (std::size_t r = next++; r < result_.runs.size() && !stopped(); r = next++) {
        try {
          settle(r);
        } catch (...) {
          const std::lock_guard guard(telling_);
          if (!error) error = std::current_exception();
          next = result_.runs.size();
        }
      }
    };
    std::vector<std::thread> others;
    for (int i = 1; i < parallel; ++i) others.emplace_back(work);
    work();
    for (std::thread& other : others) other.join();
    if (error) std::rethrow_exception(error);
  }

  /// From the first values on: of each run on a front its neighbours of the next value of each axis.
  void run_front() {
    std::set<std::vector<std::size_t>> seen;
    std::vector<std::vector<std::size_t>> todo{std::vector<std::size_t>(result_.study.axes.size(), 0)};
    while (!todo.empty() && !stopped()) {
      for (const std::vector<std::size_t>& at : todo) {
        seen.insert(at);
        if (!stopped()) settle(index_of(at));
      }
      evaluate(result_, directory_, reference_runs_);
      todo.clear();
      for (const StudyRun& run : result_.runs) {
        const bool leads = std::any_of(run.on_front.begin(), run.on_front.end(), [](char on) { return on != 0; });
        // A run that cannot be made says nothing against its neighbours.
        const bool open = seen.contains(run.plan.at) && (leads || !run.converged());
        for (std::size_t a = 0; a < run.plan.at.size() && open; ++a) {
          std::vector<std::size_t> next = run.plan.at;
          if (++next[a] < result_.study.axes[a].values.size() && !seen.contains(next) &&
              std::find(todo.begin(), todo.end(), next) == todo.end())
            todo.push_back(std::move(next));
        }
      }
    }
  }

  std::size_t index_of(const std::vector<std::size_t>& at) const {
    std::size_t index = 0;
    for (std::size_t a = 0; a < at.size(); ++a) index = index * result_.study.axes[a].values.size() + at[a];
    return index;
  }

  template <class... Args>
  void tell(fmt::format_string<Args...> text, Args&&... args) const {
    if (!options_.quiet) say("study: {}\n", fmt::format(text, std::forward<Args>(args)...));
  }

  void note(const StudyRun& run, bool found) {
    ++settled_;
    if (!found) ++computed_;
    const auto all = static_cast<std::size_t>(std::count_if(result_.runs.begin(), result_.runs.end(),
                                                            [](const StudyRun& r) { return r.plan.refused.empty(); }));
    const double each = computed_ > 0 ? seconds_since(start_) / static_cast<double>(computed_) : 0;
    const std::string left =
        computed_ > 0 && settled_ < all && result_.study.mode != StudyMode::front
            ? fmt::format(", about {} left", seconds_text(each * static_cast<double>(all - settled_)))
            : "";
    tell("{} of {}{}: {}: {}", settled_, all, left, label_of(result_, run),
         found             ? "known from before"
         : run.converged() ? seconds_text(run.record->wall)
                           : run.record->status + ": " + run.record->reason);
  }

  /// Pictures of the fastest, the most accurate and the chosen run, where the program that draws is there.
  void make_pictures() {
    const fs::path drawer = fs::read_symlink("/proc/self/exe").parent_path() / "fascia-picture";
    const std::optional<Choices> choices = choices_of(result_, result_.questions.front());
    if (!choices || !fs::exists(drawer)) return;
    for (const auto& [name, r] : {std::pair{"fastest", choices->fastest},
                                  {"most_accurate", choices->most_accurate},
                                  {"chosen", choices->chosen}}) {
      const StudyRun& run = result_.runs[r];
      const fs::path png = directory_ / "pictures" / (std::string(name) + ".png"), mark = png.string() + ".of";
      std::error_code none;
      if (stopped() || run.record->wall > kLongestForPicture) continue;
      if (fs::exists(png, none) && fs::exists(mark, none) && io::read_file(mark) == run.plan.key) continue;
      ChildRun child = child_of(result_.study.base, run.plan);
      std::erase(child.overrides, "output.picture=");
      child.overrides.emplace_back("output.picture={}");
      child.output = directory_ / "pictures" / name;
      run_child(child, [this] { return stopped(); });
      const fs::path made = child.output / (result_.study.base.stem().string() + ".png");
      if (!fs::exists(made, none)) continue;
      fs::rename(made, png);
      io::write_file(mark, run.plan.key);
      fs::remove_all(child.output, none);
    }
  }

  void write() {
    evaluate(result_, directory_, reference_runs_);
    if (!result_.interrupted) make_pictures();
    io::replace_file(directory_ / "study.csv", csv_of(result_));
    io::replace_file(directory_ / "study.json", json_of(result_).dump(2) + "\n");
    write_page(result_, directory_);
    if (options_.svg) write_plots(result_, *options_.svg, false);
    if (options_.png) write_plots(result_, *options_.png, true);
    if (options_.json) {
      fmt::print("{}\n", json_of(result_).dump(2));
    } else {
      fmt::print("{}\nstudy in {}; open {}\n", text_of(result_), directory_.string(),
                 (directory_ / "study.html").string());
    }
  }

  Interruption stop_;
  StudyOptions options_;
  fs::path directory_;
  Clock::time_point start_;
  StudyResult result_;
  std::vector<std::optional<StudyRun>> reference_runs_;  ///< by question
  std::size_t settled_ = 0, computed_ = 0;
  std::mutex telling_;
};

}  // namespace

int run_study(const StudyOptions& options) {
  if (options.vary.empty() != options.measures.empty())
    throw InputError("--vary and --measure belong together: fascia study SCENE --vary 'key=[1, 2]' --measure PROBE");
  Study study =
      options.vary.empty() ? read_study(options.study) : study_of(options.study, options.vary, options.measures);
  if (options.repeat) study.repeat = *options.repeat;
  if (options.untimed) study.timed = false;
  const fs::path directory = options.output.value_or(fs::path("results") / options.study.stem());
  return StudyDriver(std::move(study), options, directory).run();
}

}  // namespace fascia::app
