#pragma once

#include "app/bench/benchmark.hpp"
#include "app/machine.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>

/// Results of a benchmark in three forms. Times in ms; residuals are |r| / |b| after the conjugate gradients.
namespace fascia::app {

/// For reading: a line a case, its backends side by side, what was skipped and the machine below.
std::string result_table(const BenchmarkResult& result, const Machine& machine);

/// For plots: a header and a line a measurement; an empty field where the publication has no number.
std::string result_csv(const BenchmarkResult& result);

/// For programs: all of both.
nlohmann::ordered_json result_json(const BenchmarkResult& result, const Machine& machine);

}  // namespace fascia::app
