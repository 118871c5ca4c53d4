#include "app/extremes/judge.hpp"

#include "app/extremes/twin.hpp"
#include "app/run/run_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace fascia::app {
namespace {

constexpr std::array kVerdicts{"right",   "beyond",      "sensitive", "branch", "warned", "refused",
                               "stopped", "unconfirmed", "limit",     "wrong",  "crashed"};

/// All numbers of a value, in their order; what is null is no number.
void flatten(const nlohmann::ordered_json& value, std::vector<double>& numbers) {
  if (value.is_array())
    for (const auto& item : value) flatten(item, numbers);
  else if (value.is_number())
    numbers.push_back(value.get<double>());
  else
    numbers.push_back(std::numeric_limits<double>::quiet_NaN());
}

struct ProbeNumbers {
  std::string unit;
  std::vector<double> values;
};

std::map<std::string, ProbeNumbers> probes_of(const nlohmann::ordered_json& summary) {
  std::map<std::string, ProbeNumbers> probes;
  if (!summary.is_object() || !summary.contains("probes")) return probes;
  for (const auto& [name, probe] : summary["probes"].items()) {
    ProbeNumbers& p = probes[name];
    p.unit = probe.value("unit", "1");
    flatten(probe.value("value", nlohmann::ordered_json(nullptr)), p.values);
  }
  return probes;
}

bool all_finite(const std::map<std::string, ProbeNumbers>& probes) {
  return std::all_of(probes.begin(), probes.end(), [](const auto& p) {
    return std::all_of(p.second.values.begin(), p.second.values.end(), [](double v) { return std::isfinite(v); });
  });
}

struct Deviation {
  double size = 0;
  std::string probe;
};

/// The largest difference, each relative to the largest number of its unit, or to the scale
/// given for that unit.
Deviation deviation(const std::map<std::string, ProbeNumbers>& run, const std::map<std::string, ProbeNumbers>& twin,
                    std::map<std::string, double> scales, const UnitFactors& units = {}) {
  for (const auto& [name, p] : run)
    for (const double v : p.values) scales[p.unit] = std::max(scales[p.unit], std::abs(v));
  Deviation largest;
  for (const auto& [name, p] : run) {
    const auto found = twin.find(name);
    if (found == twin.end() || found->second.values.size() != p.values.size())
      return {std::numeric_limits<double>::infinity(), name};
    const double factor = units.of(p.unit), scale = scales[p.unit];
    for (std::size_t i = 0; i < p.values.size(); ++i) {
      const double apart = std::abs(p.values[i] - found->second.values[i] / factor);
      const double relative = apart == 0 ? 0 : apart / scale;
      if (!(relative <= largest.size)) largest = {relative, name};
    }
  }
  return largest;
}

std::map<std::string, ProbeNumbers> without_forces(std::map<std::string, ProbeNumbers> probes) {
  std::erase_if(probes, [](const auto& p) { return p.second.unit == "N" || p.second.unit == "N m"; });
  return probes;
}

std::optional<double> theory_error(const ExtremeCell& cell, const std::map<std::string, ProbeNumbers>& probes) {
  const auto tip = probes.find("tip");
  if (!cell.theory || tip == probes.end()) return std::nullopt;
  double squares = 0;
  for (const double v : tip->second.values) squares += v * v;
  return std::sqrt(squares) / *cell.theory - 1;
}

/// None where there is no such probe.
std::optional<double> size_of(const std::map<std::string, ProbeNumbers>& probes) {
  std::optional<double> size;
  for (const auto& [name, p] : probes)
    if (p.unit == "m")
      for (const double v : p.values) size = std::max(size.value_or(0), std::abs(v));
  return size;
}

std::map<std::string, double> in_units(std::map<std::string, double> sizes, const UnitFactors& units) {
  for (auto& [unit, size] : sizes) size *= units.of(unit);
  return sizes;
}

/// Why the run says that another one may end elsewhere; empty where it does not.
std::string first_doubt(const nlohmann::ordered_json& summary) {
  const auto found = summary.find("doubts");
  return found == summary.end() || found->empty() ? "" : found->front().get<std::string>();
}

/// Returns true where a run that stopped names its law as the cause.
bool names_law(const std::string& message) {
  return message.find("materials give way") != std::string::npos ||
         message.find("do not resist") != std::string::npos ||
         message.find("law = \"neo-hookean\"") != std::string::npos;
}

CellVerdict of_failure(const ChildResult& run) {
  if (run.timed_out) return CellVerdict::limit;
  if (run.message.find("out of memory") != std::string::npos) return CellVerdict::limit;
  if (run.message.empty()) return CellVerdict::crashed;
  if (run.exit_status == kWrongInput) return CellVerdict::refused;
  return run.exit_status == kNotConverged ? CellVerdict::stopped : CellVerdict::crashed;
}

}  // namespace

std::string name_of(CellVerdict verdict) { return kVerdicts[static_cast<std::size_t>(verdict)]; }

std::optional<CellVerdict> verdict_of(std::string_view name) {
  const auto* found = std::find(kVerdicts.begin(), kVerdicts.end(), name);
  if (found == kVerdicts.end()) return std::nullopt;
  return static_cast<CellVerdict>(found - kVerdicts.begin());
}

CellOutcome judge(const ExtremeCell& cell, const CellRuns& runs) {
  const ChildResult &run = *runs.run, &twin = *runs.twin, &disturbed = *runs.disturbed;
  CellOutcome outcome;
  outcome.status = run.status();
  outcome.reason = run.message;
  outcome.seconds = run.seconds;
  if (run.exit_status != kDone) {
    const bool says_so = run.exit_status == kWrongInput && run.message.find("nothing holds") != std::string::npos;
    outcome.verdict = !cell.has_equilibrium && says_so ? CellVerdict::right : of_failure(run);
    if (outcome.verdict == CellVerdict::stopped && !cell.is_borne && names_law(run.message))
      outcome.verdict = CellVerdict::beyond;
    return outcome;
  }
  if (!cell.has_equilibrium) {
    outcome.verdict = CellVerdict::wrong;
    outcome.reason = "nothing holds the body, which has no equilibrium, and the run ends converged";
    return outcome;
  }
  const auto numbers = probes_of(run.summary);
  if (numbers.empty() || !all_finite(numbers)) {
    outcome.reason = "a probe is no number";
    return outcome;
  }
  outcome.theory_error = theory_error(cell, numbers);
  outcome.size = size_of(numbers);
  const std::map<std::string, double> least{{"N", kNothing * cell.force}, {"m", kNothing * cell.length}};
  const auto stays = [&] {
    if (runs.sharper->exit_status != kDone) return false;
    const double change = deviation(numbers, probes_of(runs.sharper->summary), least).size;
    outcome.reason += fmt::format("; a hundredth of the tolerance changes it by {:.1e}", change);
    return change <= kAllowedDifference;
  };
  const auto without_agreement = [&](CellVerdict otherwise) {
    if (stays()) return CellVerdict::branch;
    const std::string doubt = first_doubt(run.summary);
    if (doubt.empty()) return otherwise;
    outcome.reason += "; the run says: " + doubt;
    return CellVerdict::warned;
  };
  if (twin.exit_status != kDone) {
    outcome.reason = "the twin ended so: " + twin.message;
    outcome.verdict = without_agreement(CellVerdict::unconfirmed);
    return outcome;
  }
  const auto twins = probes_of(twin.summary);
  const Deviation found = deviation(numbers, twins, least, runs.units);
  outcome.difference = found.size;
  outcome.verdict = found.size <= kAllowedDifference ? CellVerdict::right : CellVerdict::wrong;
  if (outcome.verdict == CellVerdict::right) return outcome;
  outcome.reason = fmt::format("probe {} differs from that of the twin by {:.1e}", found.probe, found.size);
  // A reaction is a sum of residuals, known no better than these; a displacement has no such excuse.
  const double floor = run.summary.value("residual_floor", 0.0);
  const bool motions_agree = deviation(without_forces(numbers), twins, least, runs.units).size <= kAllowedDifference;
  if (motions_agree && found.size <= floor) {
    outcome.verdict = CellVerdict::sensitive;
    outcome.reason += fmt::format("; the run says that rounding leaves {:.1e} of what acts", floor);
    return outcome;
  }
  if (disturbed.exit_status == kDone) {
    const double answer = deviation(twins, probes_of(disturbed.summary), in_units(least, runs.units)).size;
    // In another direction the residual may weigh a few times as much.
    if (answer >= 0.1 * found.size) outcome.verdict = CellVerdict::sensitive;
    outcome.reason += fmt::format("; forces of {:.0e} of the largest change the twin by {:.1e}", kDisturbance, answer);
  }
  if (outcome.verdict == CellVerdict::wrong) outcome.verdict = without_agreement(CellVerdict::wrong);
  return outcome;
}

}  // namespace fascia::app
