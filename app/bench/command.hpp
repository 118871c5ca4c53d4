#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

struct BenchOptions {
  std::optional<std::string> name;  ///< none: the list of benchmarks is printed
  std::vector<double> sizes;        ///< empty: all up to the limit
  std::optional<double> max_points;
  std::string settings = "both";       ///< "paper", "default", "both"
  int repeat = 0;                      ///< steps that are timed; 0: StepPlan's
  int threads = 0;                     ///< 0: all
  std::vector<int> gpus = {1};         ///< that share a run; each is a backend
  std::optional<std::string> backend;  ///< none: all that there are
  std::optional<std::filesystem::path> output;
  bool json = false, quiet = false;
};

/// Names of all benchmarks, in the order of the list that `fascia bench` prints.
inline constexpr std::array kBenchmarkNames{"table2", "table3", "gpu", "kernels", "scaling"};

/// The command. Returns the exit status.
/// @throws InputError  an unknown benchmark or size; FileError
int run_bench(const BenchOptions& options);

}  // namespace fascia::app
