#include "app/need/said_cells.hpp"

#include "app/estimate/measure.hpp"
#include "app/estimate/resolution.hpp"
#include "app/reader/parse.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

/// Orders that linear elements and frames have at least where nothing is singular.
constexpr double kOrder = 2, kOrderOfDerivatives = 1;

bool is_open(const OpenScene& open, const std::string& body) {
  return std::any_of(open.bodies.begin(), open.bodies.end(),
                     [&](const OpenBody& b) { return b.name == body && (b.cut || !b.pattern.empty()); });
}

}  // namespace

double SaidCells::ratio(const Trials& trials) const { return trials.over_allowed(error); }

SaidCells error_of_said_cells(Trials& trials, const NeedChoice& coarse) {
  SaidCells said;
  if (!trials.open().resizes()) return said;
  const Scene scene = trials.scene_of(coarse);
  SceneTwin twin;
  std::vector<std::string> names;
  for (const Body& body : scene.bodies) {
    if (is_carrier(body) || is_open(trials.open(), body.name)) continue;
    names.push_back(in_quotes(body.name));
    twin = twin + resized(scene, 2, body.name);
  }
  if (names.empty()) return said;
  said.bodies = fmt::format("{}", fmt::join(names, ", "));
  if (!twin.complete()) {
    said.unknown = fmt::format("{}", fmt::join(twin.kept, "; "));
    return said;
  }
  const Trial& own = trials.run(coarse);
  NeedChoice finer = coarse;
  finer.more.insert(finer.more.end(), twin.overrides.begin(), twin.overrides.end());
  const Trial& fine = trials.run(finer);
  if (!own.good() || !fine.good()) {
    said.unknown = fine.message;
    return said;
  }
  for (std::size_t w = 0; w < own.values.size(); ++w) {
    const double finer_than = std::exp2(is_derivative(trials.wanted()[w].quantity) ? kOrderOfDerivatives : kOrder);
    const std::optional<double> apart = relative_distance(own.values[w], fine.values[w]);
    said.error.push_back(finer_than / (finer_than - 1) * apart.value_or(INFINITY));
  }
  return said;
}

}  // namespace fascia::app
