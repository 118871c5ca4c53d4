#include "app/need/by_study.hpp"

#include "app/need/chosen.hpp"
#include "app/need/report.hpp"
#include "app/need/stored_study.hpp"
#include "app/run/messages.hpp"
#include "assembly/specification/readable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

/// Runs whose steps turned out too long, before the need counts as not met.
constexpr std::size_t kMostRuns = 5;

std::vector<std::string> overrides_of(const StudiedRun& run) {
  std::vector<std::string> overrides{"need="};
  overrides.insert(overrides.end(), run.overrides.begin(), run.overrides.end());
  return overrides;
}

/// The next cheaper run than the chosen one, and why it was not taken: a clause behind others.
std::string cheaper(const StoredStudy& study, const StatedNeed& need, std::size_t chosen) {
  if (!need.error || chosen == 0 || study.runs[chosen - 1].error <= *need.error) return "";
  const StudiedRun& run = study.runs[chosen - 1];
  return fmt::format("; {} has {:.2g} times the error that is allowed", run.label, run.error / *need.error);
}

std::vector<std::string> sentences_of(const StoredStudy& study, const StatedNeed& need, const StudiedChoice& choice,
                                      std::size_t chosen) {
  const StudiedRun& run = study.runs[chosen];
  const char* how = !choice.why_not.empty() ? "the nearest to the need"
                    : need.error            ? "the cheapest that meets the need"
                                            : "the most accurate that meets the need";
  return {fmt::format("chosen: {}: {:.0f} unknowns, {}", run.label, run.dofs, time_text(run.seconds)),
          fmt::format("why: {} of {} runs of {}{}{}", how, study.runs.size(), need.study->string(),
                      choice.why_not.empty() ? cheaper(study, need, chosen) : "",
                      study.same_machine ? "" : "; the times are another machine's"),
          fmt::format("error of {} {}{}, by the study: {}", study.measures, percent(run.error),
                      need.error ? fmt::format(" of {} allowed", percent(*need.error)) : "", study.source)};
}

Json need_json(const StoredStudy& study, const StatedNeed& need, const StudiedRun& run, const std::string& why_not) {
  Json j = json_of(need);
  j["met"] = why_not.empty();
  if (!why_not.empty()) j["why_not"] = why_not;
  j["run"] = {{"label", run.label}, {"error", run.error}, {"seconds", run.seconds}};
  j["runs"] = {{"of_the_study", study.all},
               {"of_this_scene", study.runs.size()},
               {"changing_it", study.changing},
               {"of_another", study.others}};
  return j;
}

}  // namespace

int run_by_study(const RunOptions& options, const Scene& scene) {
  const StatedNeed& need = *scene.need;
  const StoredStudy study = read_stored_study(scene);
  const StudiedChoice choice = choose_of_study(study, need);
  std::string why_not;
  for (std::size_t r = 0; r < std::min(choice.runs.size(), kMostRuns); ++r) {
    const StudiedRun& studied = study.runs[choice.runs[r]];
    const std::vector<std::string> overrides = overrides_of(studied);
    std::vector<std::string> sentences = sentences_of(study, need, choice, choice.runs[r]);
    if (r > 0) sentences[1] += fmt::format("; of the one before, {}", why_not);
    if (!options.quiet && !options.json)
      for (const std::string& line : sentences) fmt::print("{}\n", line), std::fflush(stdout);
    RunOptions run = options_of_choice(options, scene, overrides);
    run.estimate = options.estimate, run.no_estimate = options.no_estimate;
    run.complete = [&](Json& summary) {
      why_not = choice.why_not;
      if (need.step) {
        const auto p99 = summary.at("seconds").at("step_p99").get<double>();
        sentences.push_back(
            fmt::format("99 of 100 steps take at most {}, of {} allowed", time_text(p99), time_text(*need.step)));
        if (p99 > *need.step && why_not.empty())
          why_not = fmt::format("99 of 100 steps of the run take up to {}, more than in the study", time_text(p99));
      }
      const Json provenance = summary.at("provenance");
      summary.erase("provenance");
      summary["chosen"] = sentences;
      summary["need"] = need_json(study, need, studied, why_not);
      summary["provenance"] = provenance;
    };
    if (const int status = run_scene(run); status != kDone) return status;
    write_chosen_scene(scene, overrides, sentences);
    if (why_not.empty()) return kDone;
  }
  say("{}: the need is not met: {}\n", scene.path.string(), why_not);
  return kNotConverged;
}

int check_by_study(const RunOptions& options, const Scene& scene) {
  const StoredStudy study = read_stored_study(scene);
  const StudiedChoice choice = choose_of_study(study, *scene.need);
  for (const std::string& line : sentences_of(study, *scene.need, choice, choice.runs.front()))
    fmt::print("{}\n", line);
  if (!choice.why_not.empty()) fmt::print("the need is not met: {}\n", choice.why_not);
  return check_scene(options_of_choice(options, scene, overrides_of(study.runs[choice.runs.front()])));
}

}  // namespace fascia::app
