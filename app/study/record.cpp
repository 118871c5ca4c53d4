#include "app/study/record.hpp"

#include "app/study/machine_load.hpp"
#include "io/files.hpp"

#include <algorithm>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

/// From here on a run is its own warm-up [s].
constexpr double kLong = 20;
constexpr const char* kFile = "record.json";

double number_at(const Json& summary, const char* group, const char* name) {
  const auto found = summary.find(group);
  return found != summary.end() && found->is_object() ? found->value(name, 0.0) : 0.0;
}

void take_over(const ChildResult& result, RunRecord& record) {
  record.status = result.status();
  record.reason = result.message;
  record.exit_status = result.exit_status;
  record.wall = result.seconds;
  record.processor_seconds = result.processor_seconds;
  const Json& summary = result.summary;
  if (!summary.is_object()) return;
  record.memory = std::max(record.memory, summary.value("peak_memory_bytes", 0.0));
  record.step_max = std::max(record.step_max, number_at(summary, "seconds", "step_max"));
  record.dofs = summary.value("dofs", 0);
  record.steps = summary.value("steps", 0);
  record.newton = summary.value("newton_iterations", 0);
  record.linear = summary.value("linear_iterations", 0);
  record.threads = summary.value("threads", 0);
  record.backend = summary.value("backend", "");
  record.probes = summary.value("probes", Json::object());
  record.warnings = summary.value("warnings", std::vector<std::string>{});
}

Json json_of(const Spread& s) { return {{"median", s.median}, {"low", s.low}, {"high", s.high}}; }
Spread spread_at(const Json& j, const char* name) {
  const Json& s = j.at(name);
  return {s.at("median"), s.at("low"), s.at("high")};
}

}  // namespace

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return {values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2, values.front(), values.back()};
}

std::optional<RunRecord> record_run(const ChildRun& run, const std::string& key, bool timed, int warm_up, int repeat,
                                    const std::function<bool()>& stop) {
  RunRecord record;
  record.key = key;
  std::vector<double> setup, solve, step, processor;
  int warm = timed ? warm_up : 0;
  const std::size_t most = timed ? static_cast<std::size_t>(repeat) : 1;
  while (setup.size() < most) {
    const MachineLoad load;
    const ChildResult result = run_child(run, stop);
    if (stop && stop()) return std::nullopt;
    take_over(result, record);
    const bool failed = !record.converged(), is_long = result.seconds >= kLong;
    if (warm > 0 && !failed && !is_long) {
      --warm;
      continue;
    }
    warm = 0;
    setup.push_back(number_at(result.summary, "seconds", "setup"));
    solve.push_back(number_at(result.summary, "seconds", "solve"));
    step.push_back(number_at(result.summary, "seconds", "step_median"));
    processor.push_back(number_at(result.summary, "seconds", "solve_processor"));
    record.others = std::max(record.others, load.others(result.processor_seconds));
    if (failed || (is_long && setup.size() == 2)) break;
  }
  record.repeats = static_cast<int>(setup.size());
  record.setup = spread_of(setup);
  record.solve = spread_of(solve);
  record.step = spread_of(step);
  record.processor = spread_of(processor);
  return record;
}

Json json_of(const RunRecord& r) {
  return {{"key", r.key},
          {"status", r.status},
          {"reason", r.reason},
          {"exit_status", r.exit_status},
          {"setup", json_of(r.setup)},
          {"solve", json_of(r.solve)},
          {"step", json_of(r.step)},
          {"processor", json_of(r.processor)},
          {"step_max", r.step_max},
          {"wall", r.wall},
          {"processor_seconds", r.processor_seconds},
          {"memory", r.memory},
          {"dofs", r.dofs},
          {"steps", r.steps},
          {"newton", r.newton},
          {"linear", r.linear},
          {"threads", r.threads},
          {"backend", r.backend},
          {"repeats", r.repeats},
          {"others", r.others},
          {"probes", r.probes},
          {"warnings", r.warnings}};
}

std::optional<RunRecord> read_record(const std::filesystem::path& directory, const std::string& key) try {
  std::error_code none;
  if (!std::filesystem::exists(directory / kFile, none)) return std::nullopt;
  const Json j = Json::parse(io::read_file(directory / kFile));
  if (j.at("key") != key) return std::nullopt;
  RunRecord r;
  r.key = key;
  r.status = j.at("status");
  r.reason = j.at("reason");
  r.exit_status = j.at("exit_status");
  r.setup = spread_at(j, "setup");
  r.solve = spread_at(j, "solve");
  r.step = spread_at(j, "step");
  r.processor = spread_at(j, "processor");
  r.step_max = j.at("step_max");
  r.wall = j.at("wall");
  r.processor_seconds = j.at("processor_seconds");
  r.memory = j.at("memory");
  r.dofs = j.at("dofs");
  r.steps = j.at("steps");
  r.newton = j.at("newton");
  r.linear = j.at("linear");
  r.threads = j.at("threads");
  r.backend = j.at("backend");
  r.repeats = j.at("repeats");
  r.others = j.at("others");
  r.probes = j.at("probes");
  r.warnings = j.at("warnings").get<std::vector<std::string>>();
  return r;
} catch (const nlohmann::json::exception&) {
  return std::nullopt;  // of another version, or cut off: it is run again
}

void write_record(const std::filesystem::path& directory, const RunRecord& record) {
  io::make_directories(directory);
  io::replace_file(directory / kFile, json_of(record).dump(2) + "\n");
}

}  // namespace fascia::app
