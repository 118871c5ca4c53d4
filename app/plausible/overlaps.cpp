#include "app/plausible/plausible.hpp"
#include "assembly/specification/readable.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/geometry/inside.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>

namespace fascia::app {
namespace {

constexpr double kDeep = 0.005;             // of the smaller body's size: flat faces of round bodies that touch
constexpr std::size_t kMostPlaces = 20000;  // of a body that are looked at

/// Whether each edge of a surface is passed once in either direction.
bool is_closed(const TriangleMesh& surface) {
  std::set<std::array<int, 2>> open;
  for (const auto& t : surface.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (const auto other = open.find({b, a}); other != open.end())
        open.erase(other);
      else if (!open.insert({a, b}).second)
        return false;
    }
  return open.empty() && !surface.triangles.empty();
}

/// A body that fills its surface.
bool is_solid(const Simulation& s, std::size_t b) {
  const Body& body = s.scene.bodies[b];
  if (body.model == BodyModel::surface || is_shell(body) || !body.thickness.empty() || body.radius) return false;
  return is_closed(s.bodies[b].body->surface());
}

/// Pairs of bodies that the scene joins: what one has in common with the other is meant.
std::set<std::array<std::string, 2>> joined_pairs(const Scene& scene) {
  std::set<std::array<std::string, 2>> pairs;
  const auto join = [&](const std::string& a, const std::string& b) {
    pairs.insert({a, b});
    pairs.insert({b, a});
  };
  for (const Coupling& c : scene.couplings)
    if (c.kind != CouplingKind::spring) join(c.body, c.to);
  for (const Body& b : scene.bodies) {
    if (b.shares)
      for (const SharedNodes& share : *b.shares) join(b.name, share.body);
    if (const auto* between = std::get_if<BetweenDomain>(&b.domain))
      for (const std::string& other : between->bodies) join(b.name, other);
  }
  return pairs;
}

std::vector<Vec3d> places_of(const ModelBody& body) {
  std::vector<Vec3d> all = body.surface().points;
  for (const BodyPoint& p : body.points()) all.push_back(p.X);
  const std::size_t step = all.size() / kMostPlaces + 1;
  std::vector<Vec3d> some;
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

struct Deepest {
  double depth = 0;
  Vec3d where{};
};

Deepest deepest_in(const InsideTest& solid, const Bounds& bounds, const std::vector<Vec3d>& places) {
  Deepest deepest;
  for (const Vec3d& x : places) {
    if (!bounds.contains(x) || !solid.contains(x)) continue;
    const double depth = solid.distance(x);
    if (depth > deepest.depth) deepest = {depth, x};
  }
  return deepest;
}

}  // namespace

void warn_of_overlaps(Simulation& s) {
  const std::size_t n = s.bodies.size();
  if (n < 2 || s.warnings.silences("overlap")) return;
  const std::set<std::array<std::string, 2>> joined = joined_pairs(s.scene);
  std::vector<Bounds> bounds;
  for (const SimulatedBody& b : s.bodies)
    bounds.push_back(bounds_of(b.body->surface().points.empty() ? b.nodes : b.body->surface().points));
  const auto apart = [&](std::size_t a, std::size_t b) {
    for (int c = 0; c < 3; ++c)
      if (bounds[a].low[c] > bounds[b].high[c] || bounds[b].low[c] > bounds[a].high[c]) return true;
    return false;
  };
  std::map<std::size_t, std::unique_ptr<InsideTest>> tests;
  std::map<std::size_t, std::vector<Vec3d>> places;
  std::vector<std::optional<bool>> solid(n);
  const auto look = [&](std::size_t inner, std::size_t outer) -> Deepest {
    if (!solid[outer]) solid[outer] = is_solid(s, outer);
    if (!*solid[outer]) return {};
    if (!tests.contains(outer)) tests[outer] = std::make_unique<InsideTest>(s.bodies[outer].body->surface());
    if (!places.contains(inner)) places[inner] = places_of(*s.bodies[inner].body);
    return deepest_in(*tests[outer], bounds[outer], places[inner]);
  };
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b) {
      if (apart(a, b) || joined.contains({s.bodies[a].name, s.bodies[b].name})) continue;
      if (s.scene.bodies[a].model == BodyModel::surface || s.scene.bodies[b].model == BodyModel::surface) continue;
      const Deepest one = look(a, b), other = look(b, a), &deepest = one.depth > other.depth ? one : other;
      if (deepest.depth < kDeep * std::min(s.bodies[a].body->size(), s.bodies[b].body->size())) continue;
      s.warnings.add(
          "overlap", s.scene.bodies[b].domain_place,
          fmt::format("intersects body \"{}\" by {}, deepest at ({:.4g}, {:.4g}, {:.4g}): both move as if the "
                      "other were not there; move one, or couple them (\"embed\")",
                      s.bodies[a].name, length_text(deepest.depth), deepest.where[0], deepest.where[1],
                      deepest.where[2]));
    }
}

}  // namespace fascia::app
