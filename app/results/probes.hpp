#pragma once

#include "assembly/simulation/probe_values.hpp"

#include <nlohmann/json_fwd.hpp>

#include <vector>

namespace fascia::app {

/// Values of a probe as they nest: a number, a vector, a matrix, a list of these; null where there are none.
nlohmann::json probe_json(const ResolvedProbe& probe, const std::vector<double>& values);

}  // namespace fascia::app
