#pragma once

#include "app/bench/benchmark.hpp"
#include "app/machine.hpp"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

/// Parts that the reports of all benchmarks have.
namespace fascia::app {

using TableRow = std::vector<std::string>;

/// Sets columns to the width of their widest entry: the first `left` to the left, numbers to the right.
std::string aligned(const std::vector<TableRow>& rows, std::size_t left);

/// Names the machine, the build and the time, below a table.
std::string machine_lines(const Machine& machine);

/// Names the cases that were not timed, a line a reason.
std::string skipped_lines(const std::vector<SkippedCase>& skipped);

/// A field of a CSV; empty where there is no number.
std::string field(const std::optional<double>& value);

/// JSON has no NaN, which a run that went astray may leave: null stands for it.
nlohmann::ordered_json number(double value);
nlohmann::ordered_json number(const std::optional<double>& value);

/// A result without rows: names, sentences, machine and build.
nlohmann::ordered_json json_head(const std::string& name, const std::string& title, const std::string& notes,
                                 const Machine& machine);

nlohmann::ordered_json json_of(const std::vector<SkippedCase>& skipped);

}  // namespace fascia::app
