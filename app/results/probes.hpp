#pragma once

#include "assembly/simulation/probe_values.hpp"

#include <nlohmann/json_fwd.hpp>

#include <vector>

namespace fascia::app {

/// Values of a probe as they nest: a number, a vector, a matrix, a list of these; null where there are none.
nlohmann::json probe_json(const ResolvedProbe& probe, const std::vector<double>& values);

/// Takes a row into the values of a summary: frequencies grow into lists, mode by mode; all else is the last row's.
/// @param summary  of each probe; an empty list before the first row
void take_row(const Simulation& simulation, const ProbeValues& row, std::vector<nlohmann::json>& summary);

}  // namespace fascia::app
