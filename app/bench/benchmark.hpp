#pragma once

#include "app/bench/command.hpp"
#include "assembly/simulation/simulation.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

/// `fascia bench`: time steps of fixed work, on each backend, as tables.
namespace fascia::app {

/// A scene that is timed.
struct BenchmarkCase {
  std::string name;     ///< of its row and of its scene file
  std::string body;     ///< what it is, in a word or two without a comma
  std::string setting;  ///< "paper": as in the publication; "default": the program's own choice
  int size = 0;         ///< integration points or cells that are asked for
  std::string scene;    ///< TOML
  std::optional<double> published_cpu, published_gpu;  ///< a time step in the publication [ms]
};

/// A result in the forms in which the command hands it out.
struct BenchReport {
  std::string table, csv, json;
  std::vector<BenchmarkCase> cases;  ///< their scenes are written beside
};

struct Benchmark;
using Teller = std::function<void(const std::string&)>;  ///< is told what is being done

struct Benchmark {
  std::string name, title;
  std::string notes;     ///< sentences below the table
  int default_size = 0;  ///< larger cases are timed only where they are asked for
  std::vector<BenchmarkCase> cases;
  int smallest_default = 0;  ///< smaller ones likewise
  /// Runs it, where it times something else than whole steps.
  std::function<BenchReport(const Benchmark&, const BenchOptions&, const Teller&)> run{};
};

/// All of them, in the order of the list that `fascia bench` prints.
std::vector<Benchmark> all_benchmarks();

// Parts of all_benchmarks, each in a file of its own or beside its like.
Benchmark table2();    ///< tables.cpp
Benchmark table3();    ///< tables.cpp
Benchmark elements();  ///< elements.cpp
Benchmark kernels();   ///< kernels.cpp
Benchmark scaling();   ///< scaling.cpp

/// Which steps are timed: at least `fewest`, then on until `seconds` have passed or `most` are done.
struct StepPlan {
  int warm_up = 2;
  int fewest = 3, most = 100;
  double seconds = 1;
};

/// What a backend measured, one entry a step.
struct StepTimes {
  std::vector<double> step_ms, cg_ms;  ///< whole step; in conjugate gradients alone
  int cg_iterations = 0;               ///< fewest of a step
  double residual = 0;                 ///< |r| / |b| after the conjugate gradients of the first of these steps
  std::string trouble;                 ///< a sentence, where the last step met any
};

/// Something that can take a scene's time steps.
struct BenchBackend {
  std::string name;  ///< "cpu", "cuda"
  int threads = 0;   ///< of the host; 0: not a number that matters
  std::function<StepTimes(const Simulation&, const StepPlan&)> run;
  int gpus = 0;

  std::string label() const;  ///< "cpu, 1 thread", "cuda, 2 GPUs"
};

/// The backends of this build on this machine: the processor with one thread and with `threads` (0: all), the GPU, and
/// as many of them together as each of `gpus` says. @throws BackendError  there are not as many
std::vector<BenchBackend> available_backends(int threads, const std::vector<int>& gpus = {1});

/// One case on one backend.
struct Measurement {
  std::string name, body, setting;
  int points = 0, frames = 0, dofs = 0;  ///< frames: nodes of all kinds
  double neighbours = 0;                 ///< mean number of frames or vertices that move a point
  std::string backend;
  int threads = 0, gpus = 0, steps = 0;
  double step_ms = 0, step_p99_ms = 0, step_max_ms = 0, cg_ms = 0;  ///< step and CG: medians
  int cg_iterations = 0;
  double residual = 0;
  std::string trouble;
  std::optional<double> published_cpu, published_gpu;  ///< [ms]
};

/// A case that was not timed, and why.
struct SkippedCase {
  std::string name, reason;
};

struct BenchmarkResult {
  std::string name, title, notes;
  std::vector<Measurement> rows;  ///< backends of a case beside one another
  std::vector<SkippedCase> skipped;
};

/// The processor with so many threads.
BenchBackend processor(int threads);

/// Those that the options choose. @throws BackendError  where there are none
std::vector<BenchBackend> chosen_backends(const BenchOptions& options);

/// Cases that the options choose; what is above the limit goes to `skipped`.
/// @throws InputError  a size that the benchmark does not have
std::vector<BenchmarkCase> chosen_cases(const Benchmark& benchmark, const BenchOptions& options,
                                        std::vector<SkippedCase>& skipped);

/// The case's model, or none and the reason where it does not fit or the program refuses it.
std::optional<Simulation> built(const BenchmarkCase& c, std::string& reason);

/// Times the cases on the backends. A case that does not fit into memory is skipped, and the result says so.
/// @param say  is told what is being done
BenchmarkResult time_benchmark(const Benchmark& benchmark, const BenchOptions& options,
                               const std::vector<BenchBackend>& backends, const Teller& say);

}  // namespace fascia::app
