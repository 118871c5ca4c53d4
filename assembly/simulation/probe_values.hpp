#pragma once

#include "assembly/simulation/simulation.hpp"
#include "core/solver/reached.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace fascia {

/// A state with what acts there.
struct ProbedState {
  const State* state = nullptr;
  const ReachedForces* acting = nullptr;  ///< has the parts that needed_parts() says; null: there are none
  double frequency = 0;                   ///< of a mode [Hz]
  double time_step = 0;                   ///< explicit: of the step that ended here, at the start of the first one [s]
};

/// Says which parts of what acts at a state the scene's probes read, and the report on its couplings.
ReachedParts needed_parts(const Simulation& s);

/// The numbers of each probe, in a row.
using ProbeValues = std::vector<std::vector<double>>;

/// Values of all probes, of each as numbers in a row; `shape` says how they nest (vector 3, matrix 3×3, list).
/// @throws StateError  a value is not finite
ProbeValues probe_values(const Simulation& s, const ProbedState& at);
/// The number of a probe. @throws InputError  the scene has none of this name
std::size_t probe_index(const Simulation& s, std::string_view name);
/// Values of one of them. @throws StateError  one is not finite
std::vector<double> probe_value(const Simulation& s, std::size_t probe, const ProbedState& at);

/// How many numbers a value has: 1, 3 or 9.
enum class ProbeShape { scalar, vector, matrix };
ProbeShape probe_shape(Quantity quantity);
std::string probe_unit(Quantity quantity);
std::string quantity_name(Quantity quantity);
/// By the name that a scene gives it.
std::string unit_of_quantity(std::string_view name);
/// Column names of a probe in probes.csv: tip.x, tip.y, ...
std::vector<std::string> probe_columns(const ResolvedProbe& probe);

}  // namespace fascia
