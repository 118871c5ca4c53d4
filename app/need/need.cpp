#include "app/need/need.hpp"

#include "app/estimate/resolution.hpp"
#include "app/need/by_study.hpp"
#include "app/need/chosen.hpp"
#include "app/need/kept_trials.hpp"
#include "app/need/report.hpp"
#include "app/need/said_cells.hpp"
#include "app/need/search.hpp"
#include "app/need/simplify.hpp"
#include "app/need/time_search.hpp"
#include "app/reader/parse.hpp"
#include "app/run/interruption.hpp"
#include "app/run/load_scene.hpp"
#include "app/run/messages.hpp"
#include "app/run/process_memory.hpp"
#include "app/run/temporary_folder.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/specification/errors.hpp"
#include "assembly/specification/readable.hpp"
#include "core/base/clock.hpp"
#include "core/base/errors.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::app {
namespace {

/// What of a scene is wrong shows with any choice: it is told before others are tried. @return the largest size [m]
double check_first(const Trials& trials, const NeedChoice& first) {
  double size = 0;
  for (const SimulatedBody& b : build_within_memory(trials.scene_of(first)).bodies)
    size = std::max(size, b.body->size());
  return size;
}

/// Errors are relative: nothing can be said of a quantity that is 0.
/// @throws SceneError  the first trial gives rounding alone
void check_scale(const Scene& scene, Trials& trials, const NeedChoice& first, double size) {
  const Trial& trial = trials.run(first);
  for (std::size_t w = 0; w < trial.values.size(); ++w) {
    const Wanted& wanted = trials.wanted()[w];
    if (wanted.allowed && trial.values[w].largest() <= rounding_of(wanted.quantity, size))
      throw SceneError({{scene.place_of(scene.need ? "need" : "bodies"),
                         fmt::format("{} is 0 but for rounding, and no error is relative to that; name another probe",
                                     wanted.name)}});
  }
}

/// Cells that the scene says itself may have this part of the allowed error; what is open needs the rest.
constexpr double kMostSaid = 0.8;

double memory_of(const Scene& scene) {
  double memory = 0.9 * free_memory().bytes;
  if (scene.need && scene.need->memory) memory = std::min(memory, *scene.need->memory);
  return memory;
}

/// @param part  of the step that is needed, which trials may take
SearchLimits limits_of(const Scene& scene, double part) {
  SearchLimits limits;
  limits.memory = memory_of(scene);
  if (scene.need && scene.need->step) limits.step = part * *scene.need->step;
  return limits;
}

/// Looks for a choice, and what makes the scene of it. @return an exit status where there is none
std::optional<int> choose(const RunOptions& options, const Scene& scene, double part, NeedReport& report,
                          std::vector<std::string>& overrides) {
  const Clock::time_point start = Clock::now();
  Interruption stop;
  const TemporaryFolder folder("fascia-need");
  const bool silent = options.quiet || options.json;
  const auto tell = [&](const std::string& line) {
    if (!silent) fmt::print("{}\n", line), std::fflush(stdout);
  };
  const KeptTrials kept(scene, options.new_trials);
  Trials trials(scene, open_parts(scene), wanted_of(scene), folder.path(), &kept, tell,
                [&] { return stop.requested(); });
  const NeedChoice first = first_choice(trials);
  check_scale(scene, trials, first, check_first(trials, first));
  SearchLimits limits = limits_of(scene, part);
  const SaidCells said = error_of_said_cells(trials, first);
  const double of_said = said.ratio(trials);
  if (of_said < kMostSaid) limits.share -= of_said;
  limits.share -= room_for_simpler(trials, first);
  Found found =
      is_dynamic(scene.solver.kind) ? search_in_time(trials, first, limits) : search_resolution(trials, first, limits);
  found.said_error = said.error;
  if (found.met && of_said >= kMostSaid) {
    found.met = false;
    found.why_not = fmt::format(
        "the cells of {}, which the scene says, have {:.2g} times the error that is allowed; "
        "leave them out, or say finer ones",
        said.bodies, of_said);
  }
  if (!stop.requested()) simplify(trials, found);
  if (stop.requested()) {
    say("{}: interrupted while it looked for what the need asks for\n", scene.path.string());
    return 128 + stop.signal();
  }
  const Trial* trial = trials.find(found.choice);
  if (!trial || !trial->good()) {
    say("{}: the need is not met: {}\n", scene.path.string(), found.why_not);
    return kNotConverged;
  }
  report.add(trials, found, said, seconds_since(start));
  overrides = trials.overrides(found.choice);
  return std::nullopt;
}

}  // namespace

int run_need(const RunOptions& options, const Scene& scene) {
  if (scene.need && scene.need->study) return run_by_study(options, scene);
  // The run times its steps anew. Where they are longer than those of its trial again, trials must be faster.
  constexpr int runs = 6, searches = 3;
  constexpr double faster = 0.6;
  NeedReport report(scene);
  std::vector<std::string> overrides;
  double part = 1;
  for (int search = 0; search < searches && (search == 0 || report.steps_took_longer()); ++search, part *= faster) {
    if (const std::optional<int> failed = choose(options, scene, part, report, overrides)) return *failed;
    RunOptions run = options_of_choice(options, scene, overrides);
    run.complete = [&](nlohmann::ordered_json& summary) { report.write(summary); };
    if (!options.quiet && !options.json)
      for (const std::string& line : report.sentences()) fmt::print("{}\n", line);
    for (int time = 0; time < runs && (time == 0 || report.steps_were_interrupted()); ++time)
      if (const int status = run_scene(run); status != kDone) return status;
  }
  write_chosen_scene(scene, overrides, report.sentences());
  if (report.met()) return kDone;
  say("{}: {}\n", scene.path.string(), report.not_met());
  return kNotConverged;
}

int check_need(const RunOptions& options, const Scene& scene) {
  if (scene.need && scene.need->study) return check_by_study(options, scene);
  Trials trials(scene, open_parts(scene), wanted_of(scene), {}, nullptr, {}, [] { return false; });
  const NeedChoice first = first_choice(trials);
  fmt::print("need: chosen by trials of {}; the first: {}\n", families_text(trials.open()), trials.text(first));
  return check_scene(options_of_choice(options, scene, trials.overrides(first)));
}

}  // namespace fascia::app
