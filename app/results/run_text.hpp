#pragma once

#include "assembly/simulation/simulation.hpp"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>

namespace fascia::app {

/// A value of a probe with six significant digits; of a long list the beginning, and how many more there are.
std::string short_value(const nlohmann::ordered_json& value);

/// summary.json as a text in UTF-8, whatever bytes a path or a message holds.
std::string json_text(const nlohmann::ordered_json& summary);

/// Prints what a run came to, and where to look next.
/// @param shown  there is a new result; else there was nothing to show and the older one came back
void print_summary(const Simulation& s, const nlohmann::ordered_json& summary, bool shown);

}  // namespace fascia::app
