#include "app/explain/promise.hpp"

#include <algorithm>

namespace fascia::app {
namespace {

/// A rigid body that deforms by more than this many times the allowed change will hardly be suggested.
constexpr double kFar = 10;

const BodyProfile* profile_of(const Explanation& e, const std::string& body) {
  const auto found =
      std::find_if(e.bodies.begin(), e.bodies.end(), [&](const BodyProfile& b) { return b.name == body; });
  return found == e.bodies.end() ? nullptr : &*found;
}

double all_points(const Explanation& e) {
  double points = 0;
  for (const BodyProfile& b : e.bodies) points += static_cast<double>(b.points);
  return points;
}

/// A rough share of the time that a change may save: for an order, not to be told.
double promise_of(const Explanation& e, const Part& part) {
  const Variant& v = part.variant;
  if (v.closer) return 0;
  const BodyProfile* body = profile_of(e, v.body);
  const double points = all_points(e);
  const double share = body != nullptr && points > 0 ? static_cast<double>(body->points) / points : 0;
  switch (v.kind) {
    case VariantKind::rigid:
      return part.estimated_change && *part.estimated_change > kFar * e.limit ? share / kFar : share;
    case VariantKind::left_out:
    case VariantKind::order:
    case VariantKind::frame_kind:
      return share;
    case VariantKind::coarser:
      return share * (1 - v.growth);
    case VariantKind::formulation:
    case VariantKind::fluid:
      return share / 2;
    case VariantKind::law:
    case VariantKind::damping:
    case VariantKind::viscosity:
    case VariantKind::coupling:
      return 0.1;
    case VariantKind::newton_tolerance:
    case VariantKind::linear_tolerance:
    case VariantKind::linear_solver:
    case VariantKind::tangent:
    case VariantKind::precision:
    case VariantKind::backend:
    case VariantKind::threads:
    case VariantKind::time_step:
      return 1;  // of the whole scene
  }
  return 0;
}

}  // namespace

void estimate(Explanation& e) {
  const double points = all_points(e);
  double displacement = 0;
  for (const BodyProfile& b : e.bodies)
    if (b.motion) displacement = std::max(displacement, b.motion->displacement);
  for (Part& part : e.parts) {
    const BodyProfile* body = profile_of(e, part.variant.body);
    if (body == nullptr || !(points > 0)) continue;
    const double share = static_cast<double>(body->points) / points;
    const VariantKind kind = part.variant.kind;
    if (kind == VariantKind::left_out) part.estimated_gain = share;
    if (kind == VariantKind::coarser) part.estimated_gain = share * (1 - part.variant.growth);
    if (kind != VariantKind::rigid) continue;
    part.estimated_gain = share;
    if (body->motion && displacement > 0) part.estimated_change = body->motion->deformation / displacement;
  }
}

std::vector<Part*> by_promise(Explanation& e) {
  std::vector<std::pair<double, Part*>> parts;
  for (Part& part : e.parts)
    if (part.variant.refused.empty()) parts.emplace_back(promise_of(e, part), &part);
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Part*> order;
  order.reserve(parts.size());
  for (const auto& [promise, part] : parts) order.push_back(part);
  return order;
}

}  // namespace fascia::app
