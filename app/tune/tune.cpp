#include "app/tune/tune.hpp"

#include "app/machine.hpp"
#include "app/run/interruption.hpp"
#include "app/run/messages.hpp"
#include "app/run/run_scene.hpp"
#include "app/run/temporary_folder.hpp"
#include "app/study/child_run.hpp"
#include "app/tune/kept_costs.hpp"
#include "app/tune/tune_scenes.hpp"
#include "assembly/specification/readable.hpp"
#include "core/base/clock.hpp"
#include "core/base/errors.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <cmath>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// No further run is begun after this [s].
constexpr double kMostSeconds = 25;

std::optional<CostSample> timed(const TuneCase& c, const fs::path& folder, const std::function<bool()>& stop) {
  const fs::path scene = folder / "tune.toml";
  io::write_file(scene, tune_scene(c));
  const ChildResult result = run_child({scene, {}, folder / "result", c.threads, "cpu", kMostSeconds}, stop);
  if (result.exit_status != 0 || !result.summary.is_object()) return std::nullopt;
  const Json &j = result.summary, &seconds = j.at("seconds");
  CostSample s{c.kind, c.factorised, c.dynamics, j.at("threads").get<int>()};
  for (const auto& body : j.at("bodies")) s.points += body.at("points").get<double>();
  s.unknowns = j.at("dofs").get<double>();
  s.explicit_steps = c.explicit_steps ? j.at("steps").get<double>() : 0;
  s.newton = j.at("newton_iterations").get<double>();
  s.linear = j.at("linear_iterations").get<double>();
  s.courant = courant_of(c);
  s.setup = seconds.at("setup").get<double>();
  s.solve = seconds.at("solve").get<double>();
  return s;
}

double iteration(const KindCost& c, double unknowns, double points) {
  return c.point * points + c.factor * std::pow(unknowns, c.exponent);
}

/// A table: Newton iterations of 1,000 and 10,000 unknowns.
void print_table(const CostModel& model, const std::vector<CostSample>& samples) {
  fmt::print("{:14} {:>16} {:>16} {:>12} {:>10}\n", "", "1,000 unknowns", "10,000 unknowns", "~ unknowns^", "threads");
  for (const auto& [kind, cost] : model.kinds) {
    double points = 1;
    for (const CostSample& s : samples)
      if (s.kind == kind) points = s.points / s.unknowns;
    fmt::print("{:14} {:>16} {:>16} {:>12.2f} {:>9.2f}x\n", kind, time_text(iteration(cost, 1e3, 1e3 * points)),
               time_text(iteration(cost, 1e4, 1e4 * points)), cost.exponent, cost.faster_factor);
  }
}

}  // namespace

int run_tune(const TuneOptions& options) {
  const Clock::time_point start = Clock::now();
  Interruption stop;
  const TemporaryFolder folder("fascia-tune");
  const std::function<bool()> stopped = [&] { return stop.requested(); };
  std::vector<CostSample> samples;
  const std::vector<TuneCase> cases = tune_cases(options.quick, this_machine().threads);
  std::size_t run = 0;
  for (const TuneCase& c : cases) {
    if (stopped()) return 128 + stop.signal();
    if (seconds_since(start) > kMostSeconds) break;
    if (auto sample = timed(c, folder.path(), stopped)) samples.push_back(*sample);
    ++run;
  }
  const CostModel model = fitted_costs(samples);
  const double seconds = seconds_since(start);
  if (model.kinds.empty()) {
    say("fascia tune: too few of its {} runs ended to fit anything; is the machine busy?\n", cases.size());
    return kNotConverged;
  }
  const Machine machine = this_machine();
  Json j{{"fascia", machine.fascia},
         {"key", machine_key(machine)},
         {"date", machine.date},
         {"seconds", seconds},
         {"runs", run},
         {"kinds", model.json()}};
  const fs::path file = tune_file();
  if (!file.empty()) {
    io::make_directories(file.parent_path());
    io::replace_file(file, j.dump(2) + "\n");
  }
  if (options.json) {
    fmt::print("{}\n", j.dump(2));
    return kDone;
  }
  fmt::print("a Newton iteration on one thread, by factorisation ({} of {} runs in {}):\n", run, cases.size(),
             time_text(seconds));
  print_table(model, samples);
  if (file.empty())
    say("fascia tune: neither XDG_CACHE_HOME nor HOME is set, so that nothing was kept\n");
  else
    fmt::print("kept in {}\n", file.string());
  return kDone;
}

}  // namespace fascia::app
