#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace fascia::app {

/// "estimated error of tip: 1.2 % (discretisation 1.1 %, time 0.1 %, solver 2e-06 %)", a line for each probe and body.
std::vector<std::string> estimate_lines(const nlohmann::ordered_json& summary);

}  // namespace fascia::app
