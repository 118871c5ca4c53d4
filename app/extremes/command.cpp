#include "app/extremes/extremes.hpp"
#include "app/extremes/map.hpp"
#include "app/extremes/stored_map.hpp"
#include "app/extremes/sweep.hpp"
#include "app/report/report_directory.hpp"
#include "app/run/interruption.hpp"
#include "app/run/messages.hpp"
#include "app/run/run_scene.hpp"
#include "core/base/clock.hpp"
#include "core/base/errors.hpp"
#include "core/base/processors.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>

namespace fascia::app {
namespace {

/// What has ended is written so often [s].
constexpr double kSaveEvery = 5;

std::vector<ExtremeCell> cells_of(const ExtremesOptions& options) {
  if (options.scene) {
    if (options.reduced)
      throw InputError("extremes: --reduced is of the program's own map; leave it out, or the scene");
    return sweep_cells(*options.scene, options.overrides);
  }
  if (!options.overrides.empty()) throw InputError("extremes: --set changes a scene; name one");
  if (options.reduced) return reduced_cells();
  std::vector<ExtremeCell> cells = map_cells();
  for (ExtremeCell& pair : pair_cells(options.pairs)) cells.push_back(std::move(pair));
  return cells;
}

/// Those whose names hold all words.
std::vector<ExtremeCell> chosen(std::vector<ExtremeCell> cells, const std::vector<std::string>& words) {
  std::erase_if(cells, [&](const ExtremeCell& c) {
    return !std::all_of(words.begin(), words.end(),
                        [&](const std::string& w) { return c.name().find(w) != std::string::npos; });
  });
  if (cells.empty()) throw InputError("extremes: no cell's name holds all words of --only; --list prints the names");
  return cells;
}

/// Says how far it is, and once a twentieth is done how long the rest will take.
class Teller {
 public:
  explicit Teller(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}
  ~Teller() {
    if (!quiet_ && terminal_) say("\r\033[K");
  }
  Teller(const Teller&) = delete;
  Teller& operator=(const Teller&) = delete;

  void tell(std::size_t ended, std::size_t of) {
    if (quiet_) return;
    const double left = seconds_since(start_) * static_cast<double>(of - ended) / static_cast<double>(ended);
    if (terminal_)
      say("\r\033[K{} of {} cells, about {:.0f} s left", ended, of, left);
    else if (ended % std::max<std::size_t>(1, of / 20) == 0)
      say("{} of {} cells, about {:.0f} s left\n", ended, of, left);
    std::fflush(stderr);
  }

 private:
  bool quiet_, terminal_;
  Clock::time_point start_ = Clock::now();
};

std::string json_text(const ExtremesMap& map) {
  nlohmann::ordered_json j = settings_json(map);
  j["cells"] = map.cells.size();
  const std::vector<std::size_t> counts = count(map);
  for (std::size_t v = 0; v < counts.size(); ++v) j["verdicts"][name_of(static_cast<CellVerdict>(v))] = counts[v];
  j["regressions"] = map.regressions;
  j["gains"] = map.gains;
  j["jobs"] = map.settings.jobs;
  j["seconds"] = map.seconds;
  return j.dump(2) + "\n";
}

/// Runs an hour or more are announced: the cells' own limit bounds what they can take.
void announce(const ExtremesMap& map, bool quiet) {
  const double longest = 5 * map.settings.time_limit * static_cast<double>(map.cells.size()) / map.settings.jobs;
  if (!quiet)
    say("{} cells, each run at most {:g} s, {} at once: at most {:.1f} h; what is left is told as it goes\n",
        map.cells.size(), map.settings.time_limit, map.settings.jobs, longest / 3600);
}

}  // namespace

int run_extremes(const ExtremesOptions& options) {
  ExtremesMap map;
  map.title = options.scene ? "extremes of " + options.scene->filename().string() : "stability at the extremes";
  map.cells = chosen(cells_of(options), options.only);
  if (options.quicker_than > 0) {
    if (!options.compare) throw InputError("extremes: --quicker-than needs the times of an older map; add --compare");
    keep_quick(map.cells, *options.compare, options.quicker_than);
    if (map.cells.empty()) throw InputError("extremes: no cell is as quick as --quicker-than says");
  }
  map.settings = {options.jobs > 0 ? options.jobs : available_processors(), options.time_limit, options.memory_limit,
                  options.backend};
  if (options.list) {
    for (const ExtremeCell& c : map.cells) fmt::print("{}\n", c.name());
    return kDone;
  }
  if (options.resume) resume(map, options.output);
  Interruption interruption;
  const ReportDirectory directory(options.output, "extremes", {"cells", "extremes.csv", "extremes.html"});
  directory.write("extremes.json", json_text(map));
  announce(map, options.quiet);
  const Clock::time_point start = Clock::now();
  const std::size_t all = map.cells.size();
  {
    Teller teller(options.quiet);
    Clock::time_point saved = start;
    run_map(
        map, directory.path(),
        [&](std::size_t ended, std::size_t of) {
          teller.tell(ended, of);
          if (seconds_since(saved) < kSaveEvery) return;
          directory.write("extremes.csv", csv_of(map));
          saved = Clock::now();
        },
        [&] { return interruption.requested(); });
  }
  keep_ended(map);
  map.seconds = seconds_since(start);
  if (options.beside) read_beside(map, *options.beside);
  if (options.compare && !map.cells.empty()) compare_with_stored(map, *options.compare);
  directory.write("extremes.csv", csv_of(map));
  directory.write("extremes.html", html_of(map, directory.path()));
  directory.write("extremes.json", json_text(map));
  if (interruption.requested()) {
    say("interrupted: {} of {} cells are in {}; the same command with --resume goes on\n", map.cells.size(), all,
        directory.path().string());
    return 128 + interruption.signal();
  }
  fmt::print("{}map in {}: extremes.html, extremes.csv\n", text_of(map), directory.path().string());
  const bool astray = std::any_of(map.outcomes.begin(), map.outcomes.end(),
                                  [](const CellOutcome& o) { return leads_astray(o.verdict); });
  return (options.compare ? !map.regressions.empty() : astray) ? kNotConverged : kDone;
}

}  // namespace fascia::app
