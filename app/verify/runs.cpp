#include "app/verify/runs.hpp"

#include "app/compare/arrays.hpp"
#include "app/reader/parse.hpp"
#include "app/results/provenance.hpp"
#include "app/run/run_scene.hpp"
#include "app/scene/diagnostics.hpp"
#include "app/study/child_run.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <csignal>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// How a run is made again.
struct Again {
  const char* suffix;  ///< of its directory
  int threads;         ///< 0: all
};
constexpr std::array kAgain{Again{"", 1}, Again{".again", 1}, Again{".all-threads", 0}};

/// One process.
struct Task {
  std::size_t run = 0, again = 0;  ///< into the registry and kAgain, whose first is the run itself
};

/// A text's files lie beside the case file that holds it, not beside the copy that is run.
std::vector<std::string> places_of_files(const Scene& scene) {
  std::vector<std::string> changes;
  const auto set = [&](const Body& body, const char* key, const fs::path& file) {
    std::error_code failed;
    changes.push_back(
        fmt::format("{}.{}.file=\"{}\"", join("bodies", body.name), key, fs::absolute(file, failed).string()));
  };
  for (const Body& body : scene.bodies) {
    if (const auto* mesh = std::get_if<FileDomain>(&body.domain)) set(body, "domain", mesh->path);
    if (const auto* frames = std::get_if<SampleFile>(&body.frames)) set(body, "frames", frames->path);
    if (const auto* points = std::get_if<SampleFile>(&body.points)) set(body, "points", points->path);
  }
  return changes;
}

std::string command_of(const ChildRun& child) {
  std::string command = "fascia run " + quoted_for_shell(child.scene.string());
  for (const std::string& change : child.overrides) command += " --set " + quoted_for_shell(change);
  if (child.backend) command += " --backend " + *child.backend;
  return command + " --threads 1";
}

void set_all(RunOutcome& outcome, Verdict verdict, const std::string& reason) {
  for (CaseOutcome& c : outcome.cases) {
    c.verdict = verdict;
    c.reason = reason;
  }
}

/// Writes a scene that is given as text, and says how the run is begun; skips one whose files are missing.
ChildRun prepare(const VerificationRun& run, const RunSettings& settings, const VerifyDirectory& directory,
                 RunOutcome& outcome) {
  const Scene scene =
      run.text ? parse_scene_text(*run.text, run.scene, run.changes) : parse_scene_file(run.scene, run.changes);
  ChildRun child;
  child.scene = run.text ? directory.scene(run.name) : run.scene;
  child.overrides = run.changes;
  child.output = directory.run(run.name);
  child.backend = settings.backend;
  child.time_limit = settings.time_limit;
  if (run.text) {
    io::write_file(child.scene, *run.text);
    for (std::string& change : places_of_files(scene)) child.overrides.push_back(std::move(change));
  }
  outcome.command = command_of(child);
  // Fields cost more than many a run. Those of a repeated one are compared.
  const bool picture = settings.pictures && scene.output.picture;
  if (!run.repeated && !picture) child.overrides.emplace_back("output.fields=[]");
  if (!picture && scene.output.picture) child.overrides.emplace_back("output.picture=");
  std::error_code none;
  for (const fs::path& file : input_files(scene))
    if (!fs::exists(file, none)) {
      outcome.status = "skipped";
      outcome.message = file.filename().string() + " is missing; it does not come with the program";
      set_all(outcome, Verdict::skipped, outcome.message);
      break;
    }
  return child;
}

/// The states of a result go; its tables and pictures stay.
void remove_states(const fs::path& result) {
  std::vector<fs::path> states;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(result, ignored))
    if (entry.path().extension() == ".vtu" || entry.path().extension() == ".pvd") states.push_back(entry.path());
  for (const fs::path& state : states) fs::remove(state, ignored);
}

/// Whether the GPU, which was asked for, does not compute a scene.
bool not_on_backend(const ChildResult& result, const RunSettings& settings) {
  return settings.backend && result.exit_status == kNoBackend;
}

void finish(const VerificationRun& run, const RunSettings& settings, const ChildResult& result, RunOutcome& outcome) {
  outcome.done = true;
  outcome.status = not_on_backend(result, settings) ? "skipped" : result.status();
  outcome.message = result.message;
  outcome.seconds = result.seconds;
  outcome.processor_seconds = result.processor_seconds;
  if (outcome.status == "skipped") return set_all(outcome, Verdict::skipped, result.message);
  if (result.exit_status != 0 || outcome.status != "converged")
    return set_all(
        outcome, Verdict::failed,
        fmt::format("the run ended as \"{}\"{}{}", outcome.status, result.message.empty() ? "" : ": ", result.message));
  for (std::size_t c = 0; c < run.cases.size(); ++c) outcome.cases[c] = judge(run.cases[c], result.summary);
}

/// The first difference of two results, in words.
std::string words_of(const ResultDifference& difference) {
  if (!difference.structure.empty()) return difference.structure.front();
  for (const QuantityDifference& q : difference.quantities)
    if (q.absolute != 0) return fmt::format("{} differs by {:.3g}", q.name, q.absolute);
  return "";
}

Repetition compare(const VerifyDirectory& directory, const std::string& name, const Again& again, int threads) {
  try {
    const ResultDifference difference = compare_results(directory.run(name), directory.run(name + again.suffix));
    const bool equal = difference.exact() && difference.numbers() > 0;
    return {threads, equal, equal ? "" : words_of(difference)};
  } catch (const std::exception& e) {
    return {threads, false, e.what()};
  }
}

}  // namespace

std::vector<RunOutcome> run_cases(const Registry& runs, const RunSettings& settings, const VerifyDirectory& directory,
                                  const std::function<void(std::size_t, const RunOutcome&)>& done,
                                  const std::function<bool()>& stop) {
  std::vector<RunOutcome> outcomes(runs.size());
  std::vector<ChildRun> children;
  std::vector<Task> tasks;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    outcomes[r].cases.resize(runs[r].cases.size());
    children.push_back(prepare(runs[r], settings, directory, outcomes[r]));
    if (outcomes[r].status == "skipped") {
      outcomes[r].done = true;
      continue;
    }
    for (std::size_t a = 0; a < (runs[r].repeated ? kAgain.size() : 1); ++a) tasks.push_back({r, a});
  }
  // Long ones first, so that no long one is left alone at the end.
  std::stable_sort(tasks.begin(), tasks.end(),
                   [&](const Task& a, const Task& b) { return runs[a.run].full && !runs[b.run].full; });
  std::vector<ChildRun> queue;
  for (const Task& task : tasks) {
    ChildRun child = children[task.run];
    child.output += kAgain[task.again].suffix;
    child.threads = kAgain[task.again].threads;
    queue.push_back(std::move(child));
  }

  std::vector<std::array<ChildResult, kAgain.size()>> results(runs.size());
  run_children(
      queue, settings.jobs,
      [&](std::size_t i, ChildResult result) {
        const Task& task = tasks[i];
        // Ctrl-C on a terminal reaches this process and its children.
        const bool ended = result.exit_status == 0 || (result.exit_status != 128 + SIGINT && !stop());
        results[task.run][task.again] = std::move(result);
        if (task.again > 0 || !ended) return;
        finish(runs[task.run], settings, results[task.run][0], outcomes[task.run]);
        if (!runs[task.run].repeated) remove_states(queue[i].output);
        done(task.run, outcomes[task.run]);
      },
      stop);

  for (std::size_t r = 0; r < runs.size(); ++r) {
    RunOutcome& outcome = outcomes[r];
    if (!outcome.done) {
      outcome.status = "interrupted";
      set_all(outcome, Verdict::skipped, "interrupted");
    }
    if (!runs[r].repeated) continue;
    for (std::size_t a = 1; a < kAgain.size(); ++a)
      if (outcome.status == "converged" && results[r][a].summary.is_object())
        outcome.repetitions.push_back(
            compare(directory, runs[r].name, kAgain[a], results[r][a].summary.value("threads", 1)));
    for (const Again& again : kAgain) remove_states(directory.run(runs[r].name + again.suffix));
  }
  return outcomes;
}

}  // namespace fascia::app
