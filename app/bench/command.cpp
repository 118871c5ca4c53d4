#include "app/bench/benchmark.hpp"
#include "app/bench/report.hpp"
#include "app/run_scene.hpp"
#include "core/model/errors.hpp"
#include "io/files.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>

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
class Teller {
 public:
  explicit Teller(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}
  void operator()(const std::string& what) const {
    if (quiet_) return;
    if (terminal_)
      fmt::print(stderr, "\r\033[K{}", what);
    else
      fmt::print(stderr, "{}\n", what);
    std::fflush(stderr);
  }
  void finish() const {
    if (!quiet_ && terminal_) fmt::print(stderr, "\r\033[K");
  }

 private:
  bool quiet_, terminal_;
};

void write_files(const BenchOptions& options, const Benchmark& benchmark, const BenchmarkResult& result,
                 const Machine& machine) {
  const std::filesystem::path folder = *options.output;
  io::write_file(folder / (result.name + ".txt"), result_table(result, machine));
  io::write_file(folder / (result.name + ".csv"), result_csv(result));
  io::write_file(folder / (result.name + ".json"), result_json(result, machine).dump(2) + "\n");
  std::vector<SkippedCase> skipped;
  for (const BenchmarkCase& c : chosen_cases(benchmark, options, skipped))
    io::write_file(folder / "scenes" / (c.name + ".toml"), c.scene);
}

}  // namespace

std::vector<Benchmark> all_benchmarks() { return {table2(), table3(), elements()}; }

int run_bench(const BenchOptions& options) {
  const std::vector<Benchmark> benchmarks = all_benchmarks();
  if (!options.name) {
    print_list(benchmarks);
    return kDone;
  }
  const Benchmark& benchmark = find(benchmarks, *options.name);
  if (options.output) io::make_directories(*options.output);
  const Teller say(options.quiet || options.json);
  const BenchmarkResult result =
      time_benchmark(benchmark, options, chosen_backends(options), [&](const std::string& what) { say(what); });
  say.finish();
  const Machine machine = this_machine();
  if (options.output) write_files(options, benchmark, result, machine);
  if (options.json)
    fmt::print("{}\n", result_json(result, machine).dump(2));
  else
    fmt::print("{}", result_table(result, machine));
  if (options.output && !options.json) fmt::print("results and scenes in {}\n", options.output->string());
  return kDone;
}

}  // namespace fascia::app
