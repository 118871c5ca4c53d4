#pragma once

#include "app/tune/cost_model.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace fascia::app {

struct Machine;

/// Costs hold for this alone: the processor, as many threads, this version.
nlohmann::ordered_json machine_key(const Machine& machine);

/// tune.json in the user's cache; empty where there is none.
std::filesystem::path tune_file();

/// The costs that were kept for this machine and version; none where there is nothing. @param told  why a file that is
/// there is not used, a sentence; else empty
std::optional<CostModel> kept_costs(std::string& told);

/// "time: about 0.4 s on this machine (5 Newton iterations assumed)", or why it cannot be said, or that `fascia tune`
/// would; empty where there is nothing to say.
std::string time_line(const Simulation& simulation);

}  // namespace fascia::app
