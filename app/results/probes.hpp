#pragma once

#include "app/assembly/simulation.hpp"
#include "core/solver/reached.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace fascia::app {

/// A state with what acts there.
struct Snapshot {
  const State* state = nullptr;
  const ReachedForces* acting = nullptr;  ///< has the parts that needed_parts() says; null: there are none
  double frequency = 0;                   ///< of a mode [Hz]
  double time_step = 0;                   ///< explicit: of the step that ended here, at the start of the first one [s]
};

/// Says which parts of what acts at a state the scene's probes read, and the report on its couplings.
ReachedParts needed_parts(const Simulation& s);

/// Values of all probes, of each as numbers in a row; `shape` says how they nest (vector 3, matrix 3×3, list).
std::vector<std::vector<double>> probe_values(const Simulation& s, const Snapshot& at);
nlohmann::json probe_json(const ResolvedProbe& probe, const std::vector<double>& values);
std::string probe_unit(Quantity quantity);
std::string quantity_name(Quantity quantity);
/// By the name that a scene gives it.
std::string unit_of_quantity(std::string_view name);
/// Column names of a probe in probes.csv: tip.x, tip.y, ...
std::vector<std::string> probe_columns(const ResolvedProbe& probe);

}  // namespace fascia::app
