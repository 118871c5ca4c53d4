#include "app/bench/benchmark.hpp"
#include "app/bench/report.hpp"
#include "app/run/messages.hpp"
#include "app/run/run_scene.hpp"
#include "core/base/errors.hpp"
#include "io/files.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <fstream>

namespace fascia::app {
namespace {

void print_list(const std::vector<Benchmark>& benchmarks) {
  fmt::print("benchmarks:\n");
  for (const Benchmark& b : benchmarks) fmt::print("  {:<8} {}\n", b.name, b.title);
  fmt::print("fascia bench NAME runs one; fascia bench --help says with which options\n");
}

const Benchmark& find(const std::vector<Benchmark>& benchmarks, const std::string& name) {
  std::string known;
  for (const Benchmark& b : benchmarks) {
    if (b.name == name) return b;
    known += (known.empty() ? "" : ", ") + b.name;
  }
  throw InputError(fmt::format("no benchmark is called \"{}\"; must be one of {}", name, known));
}

/// Says on standard error what is being timed: on a terminal in one line that is overwritten.
class Progress {
 public:
  explicit Progress(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}
  void operator()(const std::string& what) const {
    if (quiet_) return;
    if (terminal_)
      say("\r\033[K{}", what);
    else
      say("{}\n", what);
    std::fflush(stderr);
  }
  void finish() const {
    if (!quiet_ && terminal_) say("\r\033[K");
  }

 private:
  bool quiet_, terminal_;
};

/// @throws FileError  files that are no result of this benchmark would be lost
void check_replaceable(const std::filesystem::path& folder, const std::string& name) {
  std::ifstream stream(folder / (name + ".json"), std::ios::binary);
  const nlohmann::json older = stream ? nlohmann::json::parse(stream, nullptr, false) : nlohmann::json();
  if (older.is_object() && older.value("benchmark", "") == name) return;
  for (const char* kind : {".txt", ".csv", ".json"})
    if (const std::filesystem::path file = folder / (name + kind); std::filesystem::exists(file))
      throw FileError(file.string() +
                      ": exists and is no result of this benchmark; remove it or choose another directory");
}

void write_files(const std::filesystem::path& folder, const Benchmark& benchmark, const BenchReport& report) {
  for (const BenchmarkCase& c : benchmark.cases) {
    std::error_code absent;
    std::filesystem::remove(folder / "scenes" / (c.name + ".toml"), absent);  // of an older result
  }
  io::write_file(folder / (benchmark.name + ".txt"), report.table);
  io::write_file(folder / (benchmark.name + ".csv"), report.csv);
  io::write_file(folder / (benchmark.name + ".json"), report.json);
  for (const BenchmarkCase& c : report.cases) io::write_file(folder / "scenes" / (c.name + ".toml"), c.scene);
}

/// Whole steps.
BenchReport time_steps(const Benchmark& benchmark, const BenchOptions& options, const Teller& say) {
  const BenchmarkResult result = time_benchmark(benchmark, options, chosen_backends(options), say);
  const Machine machine = this_machine();
  std::vector<SkippedCase> skipped;
  return {result_table(result, machine), result_csv(result), result_json(result, machine).dump(2) + "\n",
          chosen_cases(benchmark, options, skipped)};
}

}  // namespace

std::vector<Benchmark> all_benchmarks() { return {table2(), table3(), elements(), kernels(), scaling()}; }

int run_bench(const BenchOptions& options) {
  const std::vector<Benchmark> benchmarks = all_benchmarks();
  if (!options.name) {
    const bool more = options.json || options.output || !options.sizes.empty() || options.max_points ||
                      options.repeat > 0 || options.threads > 0 || options.backend ||
                      options.gpus != std::vector<int>{1};
    if (more) throw InputError("bench: these options need a benchmark, as in: fascia bench table3 --sizes 360");
    print_list(benchmarks);
    return kDone;
  }
  const Benchmark& benchmark = find(benchmarks, *options.name);
  if (options.output) {
    check_replaceable(*options.output, benchmark.name);
    io::make_directories(*options.output);
  }
  const Progress say(options.quiet || options.json);
  const Teller tell = [&](const std::string& what) { say(what); };
  const BenchReport report =
      benchmark.run ? benchmark.run(benchmark, options, tell) : time_steps(benchmark, options, tell);
  say.finish();
  if (options.output) write_files(*options.output, benchmark, report);
  fmt::print("{}", options.json ? report.json : report.table);
  if (options.output && !options.json) fmt::print("results and scenes in {}\n", options.output->string());
  return kDone;
}

}  // namespace fascia::app
