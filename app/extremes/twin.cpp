#include "app/extremes/twin.hpp"

#include "app/reader/overrides.hpp"
#include "app/scene/diagnostics.hpp"
#include "app/scene/toml_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fascia::app {
namespace {

/// No powers of two, and no round ones.
constexpr UnitFactors kOtherUnits{7.3, 0.37, 1.9};

/// A direction of length 1 and of no symmetry that a body may have.
constexpr std::array kSkew{0.48, 0.6, 0.64};

void largest(const nlohmann::ordered_json& value, double& size) {
  if (value.is_array())
    for (const auto& item : value) largest(item, size);
  else if (value.is_number())
    size = std::max(size, std::abs(value.get<double>()));
}

/// Acceleration by which a force of `kDisturbance` of the largest acts on all mass [m/s2]; 0 where none is told.
double disturbance(const nlohmann::ordered_json& summary) {
  double force = 0, mass = 0;
  if (!summary.is_object() || !summary.contains("probes") || !summary.contains("bodies")) return 0;
  for (const auto& [name, probe] : summary["probes"].items())
    if (probe.value("unit", "") == "N") largest(probe["value"], force);
  for (const auto& [name, body] : summary["bodies"].items()) mass += body.value("mass", 0.0);
  return mass > 0 ? kDisturbance * force / mass : 0;
}

}  // namespace

std::string document_text(const Value& document) {
  std::string text;
  for (const Member& m : *document.as_table()) text += toml_key(m.key) + " = " + toml_text(m.value) + "\n";
  return text;
}

Twin twin_of(const ExtremeCell& cell) {
  Value document = parse_toml(cell.text);
  Twin twin;
  if (change_units(document, kOtherUnits)) twin.units = kOtherUnits;
  twin.text = document_text(document);
  return twin;
}

std::optional<Twin> disturbed_twin(const ExtremeCell& cell, const nlohmann::ordered_json& summary) {
  const double acceleration = disturbance(summary);
  if (acceleration == 0) return std::nullopt;
  Twin twin = twin_of(cell);
  Value document = parse_toml(twin.text);
  const Value* world = document.find("world");
  const Value* gravity = world != nullptr ? world->find("gravity") : nullptr;
  const Array* components = gravity != nullptr ? gravity->as_array() : nullptr;
  std::array<double, 3> g{};
  for (std::size_t i = 0; i < g.size(); ++i) {
    const std::optional<double> old = components != nullptr ? number_in(components->at(i)) : 0.0;
    if (!old) return std::nullopt;
    g[i] = *old + kSkew[i] * acceleration * twin.units.of("m/s2");
  }
  Diagnostics none("");
  apply_override(document, fmt::format("world.gravity=[{:.17g}, {:.17g}, {:.17g}]", g[0], g[1], g[2]), none);
  twin.text = document_text(document);
  return twin;
}

const std::vector<std::string>& twin_solver() {
  static const std::vector<std::string> overrides{"solver.linear={kind=\"cholesky\"}", "solver.newton.tolerance=1e-10",
                                                  "solver.backend=\"cpu\"", "solver.precision=\"double\""};
  return overrides;
}

const std::vector<std::string>& sharper_solver() {
  static const std::vector<std::string> overrides{"solver.newton.tolerance=1e-10", "solver.linear.tolerance=1e-8"};
  return overrides;
}

}  // namespace fascia::app
