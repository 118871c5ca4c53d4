#pragma once

#include "assembly/simulation/simulation.hpp"
#include "core/solver/reached.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <utility>
#include <vector>

namespace fascia::app {

/// Name and entry of each coupling in summary.json.
using CouplingReports = std::vector<std::pair<std::string, nlohmann::ordered_json>>;

/// Tells what each coupling carries at a state, with all parts of what acts there: welds, embeddings and springs by
/// name, and bodies that share frames by theirs. Forces are those on `body` of a coupling, of a tissue those on each
/// body that it is tied to; moments are about the origin of the world.
CouplingReports coupling_report(const Simulation& simulation, const ReachedForces& acting, const State& state);

/// "1 frame", "2 frames"
std::string counted(std::size_t count, const char* word);

/// The layout of couplings in sentences, a line each: who shares how many nodes with whom, what follows what, what each
/// body could do alone, mechanisms.
std::string coupling_layout(const Simulation& simulation);

}  // namespace fascia::app
