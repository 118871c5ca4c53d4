#pragma once

#include "app/compare/settings.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace fascia::app {

/// A number that two summaries have.
struct Figure {
  std::string name, unit;
  double a = 0, b = 0;
};

/// Energies, and what couplings carry: stabilization, energy, force and gap of each coupling, pressure and volume of
/// each enclosed fluid.
std::vector<Figure> energy_figures(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

/// The cost: set-up, solve, median and 99th percentile of a step [s], peak memory, unknowns, steps, iterations.
std::vector<Figure> cost_figures(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

/// Who computed the two, where that differs: version, commit, compiler, library, backend, precision, threads, machine.
std::vector<Difference> program_differences(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

}  // namespace fascia::app
