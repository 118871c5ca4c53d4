#pragma once

#include "app/bench/kernel_runs.hpp"

#include <vector>

/// Results of the benchmarks of kernels as table, CSV and JSON, with the rates of the machine.
namespace fascia::app {

/// A line a kernel and number of threads: time by item, rates, the part of the machine's limit.
BenchReport report_of_kernels(const KernelResult& result, const Teams& teams, const std::vector<BenchmarkCase>& cases);

/// A line a kernel and number of threads: time, speed-up, efficiency.
BenchReport report_of_scaling(const KernelResult& result, const Teams& teams, const std::vector<BenchmarkCase>& cases);

}  // namespace fascia::app
