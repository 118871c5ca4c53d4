#include "app/plausible/plausible.hpp"
#include "assembly/specification/readable.hpp"
#include "core/base/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

constexpr double kStiffSpring = 1e5, kSoftSpring = 1e-7;  // of the body's own stiffness E A / L
constexpr double kIdleSpring = 1.0 / 500;                 // of another one on the same body
constexpr double kApart = 0.25, kLongSpring = 30;         // of a body's size

Place place_of_stiffness(const Scene& scene, const Coupling& c) {
  return scene.place_of("couplings." + c.name + ".stiffness");
}

void warn_of_stiffness(Simulation& s, const Coupling& c, std::size_t b) {
  const BodyScale scale = scale_of(s, b);
  const double own = scale.stiffest * scale.area / scale.length, ratio = c.stiffness / own;
  if (ratio > kStiffSpring || ratio < kSoftSpring)
    s.warnings.add("spring", place_of_stiffness(s.scene, c),
                   fmt::format("{:.4g} N/m, {:.1e} of what stretches body \"{}\" ({:.4g} N/m); write the unit, as "
                               "\"50 N/m\"",
                               c.stiffness, ratio, c.body, own));
  const Coupling* stiffest = &c;
  for (const Coupling& other : s.scene.couplings)
    if (other.kind == CouplingKind::spring && other.body == c.body && other.stiffness > stiffest->stiffness)
      stiffest = &other;
  if (c.stiffness < kIdleSpring * stiffest->stiffness)
    s.warnings.add("spring", place_of_stiffness(s.scene, c),
                   fmt::format("{:.4g} N/m does next to nothing beside couplings.{}, {:.4g} N/m, on the same body; "
                               "write the unit, as \"0.2 N/mm\"",
                               c.stiffness, stiffest->name, stiffest->stiffness));
}

void warn_of_length(Simulation& s, const Coupling& c, const BuiltCoupling& built, std::size_t b) {
  double length = 0;
  for (const int node : built.nodes) length = std::max(length, norm(s.model.rest_position[at(node)] - c.point));
  if (length > kLongSpring * s.bodies[b].body->size())
    s.warnings.add("apart", s.scene.place_of("couplings." + c.name + ".point"),
                   fmt::format("lies {} from body \"{}\", which is {} in size; write lengths with their unit, as "
                               "\"100 mm\"",
                               length_text(length), c.body, length_text(s.bodies[b].body->size())));
}

/// What pulls a body where no constraint holds it: its weight and the loads on it [N].
Vec3d free_pull(const Simulation& s, std::size_t b) {
  const std::vector<int>& nodes = s.bodies[b].node_ids;
  Vec3d pull = s.scene.world.gravity * s.bodies[b].body->mass();
  for (const Load& load : s.scene.loads)
    if (load.body == s.bodies[b].name) pull += load.total_force.value_or(Vec3d{}) + load.force.value_or(Vec3d{});
  for (const FrameConstraint& c : s.model.constraints)
    if (std::find(nodes.begin(), nodes.end(), c.node) != nodes.end())
      for (int k = 0; k < c.translations; ++k) {
        const Vec3d axis = c.translation_axes.row(k);
        pull = pull - axis * dot(axis, pull);
      }
  return pull;
}

/// Springs alone bear a body, and give way by more than its size.
void warn_of_weak_springs(Simulation& s, std::size_t b) {
  const auto shares = [](const SimulatedBody& other) { return !other.body->shared_nodes().empty(); };
  if (std::any_of(s.bodies.begin(), s.bodies.end(), shares)) return;
  double stiffness = 0;
  const Coupling* first = nullptr;
  for (const Coupling& c : s.scene.couplings) {
    if (c.body != s.bodies[b].name && c.to != s.bodies[b].name) continue;
    if (c.kind != CouplingKind::spring) return;
    if (first == nullptr) first = &c;
    stiffness += c.stiffness;
  }
  if (first == nullptr || stiffness <= 0) return;
  const double pull = norm(free_pull(s, b)), way = pull / stiffness;
  if (way > s.bodies[b].body->size())
    s.warnings.add("spring", place_of_stiffness(s.scene, *first),
                   fmt::format("{:.4g} N/m: body \"{}\", which {:.3g} N pull, moves {} away from where it is drawn; "
                               "write the unit, as \"0.2 N/mm\"",
                               first->stiffness, first->body, pull, length_text(way)));
}

void warn_of_gap(Simulation& s, const Coupling& c, const BuiltCoupling& built) {
  const ModelBody& own = *s.bodies[at(body_index(s, c.body))].body;
  const ModelBody& other = *s.bodies[at(body_index(s, c.to))].body;
  double gap = 0;
  for (const int node : built.nodes) gap = std::max(gap, other.distance(s.model.rest_position[at(node)]));
  if (gap > kApart * own.size())
    s.warnings.add("apart", s.scene.place_of("couplings." + c.name + ".where"),
                   fmt::format("takes nodes up to {} away from \"{}\"; take those beside it, or move one of the two",
                               length_text(gap), c.to));
}

}  // namespace

void warn_of_couplings(Simulation& s) {
  for (std::size_t k = 0; k < s.scene.couplings.size(); ++k) {
    const Coupling& c = s.scene.couplings[k];
    const auto b = static_cast<std::size_t>(body_index(s, c.body));
    if (c.kind != CouplingKind::spring) {
      warn_of_gap(s, c, s.couplings[k]);
      continue;
    }
    if (scale_of(s, b).softest > 0) warn_of_stiffness(s, c, b);
    warn_of_length(s, c, s.couplings[k], b);
  }
  for (std::size_t b = 0; b < s.bodies.size(); ++b) warn_of_weak_springs(s, b);
}

}  // namespace fascia::app
