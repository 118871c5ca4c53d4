#include "app/explain/suggestions.hpp"

#include "app/reader/parse.hpp"
#include "app/study/tables.hpp"
#include "assembly/specification/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace fascia::app {
namespace {

/// Gains below this are not worth a line in a scene.
constexpr double kLeastGain = 0.01;

/// The next number with one digit: 0.0123 → 0.02.
double rounded_up(double value) {
  if (!(value > 0)) return 0;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  return std::ceil(value / power * (1 - 1e-12)) * power;
}

std::string motion_text(const BodyMotion& motion) {
  std::string text = fmt::format("stays below {:g}°", rounded_up(motion.rotation * 180 / std::numbers::pi));
  if (motion.strain) text += fmt::format(" and {:g} % strain", rounded_up(100 * *motion.strain));
  return text;
}

bool speaks_of_motion(VariantKind kind) { return kind == VariantKind::rigid || kind == VariantKind::formulation; }

/// "`bodies.kidney` stays below 2° and 1 % strain: as `model = \"rigid\"`", "Without `couplings.ligament`"
std::string subject_text(const Explanation& e, const Variant& v) {
  const bool named =
      v.change.find("`" + v.part + "`") != std::string::npos || v.change.find("`" + v.part + " ") != std::string::npos;
  if (named || v.body.empty()) {
    std::string text = v.change;
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
  }
  const std::string body = "`" + v.part.substr(0, v.part.find('.', std::string("bodies.").size())) + "`";
  const auto profile =
      std::find_if(e.bodies.begin(), e.bodies.end(), [&](const BodyProfile& b) { return b.name == v.body; });
  if (speaks_of_motion(v.kind) && profile != e.bodies.end() && profile->motion)
    return fmt::format("{} {}: {}", body, motion_text(*profile->motion), v.change);
  return fmt::format("{} {}", body, v.change);
}

/// One of these for each body or key goes with the others.
std::string place_of_change(const Variant& v) { return v.body.empty() ? v.part : "bodies." + v.body; }

bool removes_from_a_list(const Variant& v) {
  return std::any_of(v.overrides.begin(), v.overrides.end(),
                     [](const std::string& o) { return o.starts_with("constraints[") || o.starts_with("loads["); });
}

bool keeps_every_probe(const Explanation& e, const Part& part) {
  return !part.changes.empty() && std::all_of(part.changes.begin(), part.changes.end(), [&](const ProbeChange& c) {
    return c.relative && *c.relative < e.limit;
  });
}

/// It is left open whether the gain is more than chance.
bool may_be_worth(const Explanation& e, const Part& part) {
  if (part.variant.closer || !part.variant.refused.empty()) return false;
  if (e.quick) return part.estimated_gain > kLeastGain && part.estimated_change && *part.estimated_change < e.limit;
  return part.measured() && part.solve.median < 1 - kLeastGain && keeps_every_probe(e, part);
}

double gain_of(const Explanation& e, const Part& part) { return e.quick ? part.estimated_gain : 1 - part.solve.median; }

std::string percent(double share) { return fmt::format("{:.2g}", 100 * share); }

}  // namespace

bool is_worth(const Explanation& e, const Part& part) {
  return may_be_worth(e, part) && (e.quick || part.solve.is_less());
}

std::vector<Part*> worth_suggesting(Explanation& e) {
  std::vector<Part*> parts;
  for (Part& part : e.parts)
    if (may_be_worth(e, part)) parts.push_back(&part);
  std::stable_sort(parts.begin(), parts.end(),
                   [&](const Part* a, const Part* b) { return gain_of(e, *a) > gain_of(e, *b); });
  return parts;
}

std::string gain_text(const Explanation& e, const Part& part, const Ratio& solve, bool estimated) {
  const bool by_step = is_dynamic(e.scene.solver.kind) && (!part.record || part.record->steps == e.base.steps);
  const char* what = by_step ? "the step" : "the solve";
  if (estimated) return fmt::format("{} would be about {} % shorter", what, percent(1 - solve.median));
  return fmt::format("{} is {} % shorter ({} to {} %)", what, percent(1 - solve.median), percent(1 - solve.high),
                     percent(1 - solve.low));
}

std::string change_text(const Explanation& e, const ProbeChange& change) {
  const std::string probe = fmt::format("probe `{}`", change.probe);
  if (!(*change.relative > 0)) return e.scene.probes.size() > 1 ? "no probe changes" : probe + " does not change";
  return fmt::format("{} changes{} by {}", probe, e.scene.probes.size() > 1 ? " most," : "",
                     error_text(*change.relative));
}

Suggestion suggestion_of(const Explanation& e, const Part& part, const Ratio& solve) {
  Suggestion s;
  s.overrides = part.variant.overrides;
  s.solve = solve;
  s.estimated = e.quick;
  s.text = subject_text(e, part.variant) + " " + gain_text(e, part, solve, e.quick);
  if (e.quick) {
    s.text +=
        fmt::format(", and displacements would change by about {} (estimates)", error_text(*part.estimated_change));
  } else if (const ProbeChange* largest = part.largest_change()) {
    s.change = *largest;
    s.text += ", and " + change_text(e, *largest);
    const std::string& body = part.variant.body;
    if (!body.empty() && std::none_of(e.scene.probes.begin(), e.scene.probes.end(),
                                      [&](const Probe& p) { return !p.body || p.body == body; }))
      s.text += "; none is on this body";
  }
  s.text += ".";
  return s;
}

std::vector<std::string> combined(Explanation& e, const std::vector<const Part*>& parts) {
  std::vector<std::string> overrides;
  std::set<std::string> places;
  bool from_list = false;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Variant& v = parts[i]->variant;
    Suggestion& s = e.suggestions[i];
    // An entry that is taken out of a list moves the places that another one names.
    s.carried_out = !places.contains(place_of_change(v)) && !(from_list && removes_from_a_list(v));
    if (!s.carried_out) continue;
    std::vector<std::string> with = e.scene.overrides;
    with.insert(with.end(), overrides.begin(), overrides.end());
    with.insert(with.end(), v.overrides.begin(), v.overrides.end());
    try {
      parse_scene_file(e.scene.path, with);
    } catch (const SceneError&) {
      s.carried_out = false;
      continue;
    }
    overrides.insert(overrides.end(), v.overrides.begin(), v.overrides.end());
    places.insert(place_of_change(v));
    from_list = from_list || removes_from_a_list(v);
  }
  return places.size() > 1 ? overrides : std::vector<std::string>{};
}

}  // namespace fascia::app
