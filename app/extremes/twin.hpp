#pragma once

#include "app/extremes/cells.hpp"
#include "app/extremes/other_units.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// A cell's scene in other units of mass, length and time; its numbers have no digits in common with the cell's.
struct Twin {
  std::string text;
  UnitFactors units;  ///< all 1 where files hold numbers that cannot be reached
};

Twin twin_of(const ExtremeCell& cell);

/// Overrides by which a twin is solved: by a factorisation on the processor, to a hundredth of the usual tolerance.
const std::vector<std::string>& twin_solver();

/// Overrides by which a cell itself is solved again.
const std::vector<std::string>& sharper_solver();

/// The twin under gravity across all axes that pulls with `kDisturbance` of the largest force of the run. A scene that
/// answers it as much as two runs differ does not determine its answer further than residuals are told.
/// @param summary  of the cell's run, whose probes tell forces
/// @return none  no probe tells a force
std::optional<Twin> disturbed_twin(const ExtremeCell& cell, const nlohmann::ordered_json& summary);

/// The residual that is called converged by default, relative to the largest force.
inline constexpr double kDisturbance = 1e-8;

/// A document as TOML, a line for each key at top level.
std::string document_text(const Value& document);

}  // namespace fascia::app
