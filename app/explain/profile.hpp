#pragma once

#include "app/explain/explanation.hpp"
#include "assembly/simulation/simulation.hpp"

namespace fascia::app {

/// Unknowns, points and cells of the bodies of a scene; a node that several share counts for its owner.
std::vector<BodyProfile> profile_of(const Simulation& simulation);

/// Stages of a run. @param summary  its summary.json
/// @param program, built  peak memory of a process that has read the scene, and that has built it [bytes]
Stages stages_of(const nlohmann::ordered_json& summary, const RunRecord& record, double program, double built);

/// Gives each body its share of the time and memory: measured where it was left out or made rigid; of the time its
/// share of the points, as an estimate, where it was neither or the spread is larger than what it takes.
void share_out(Explanation& explanation);

}  // namespace fascia::app
