#include "app/regions.hpp"

#include "app/scene/errors.hpp"
#include "core/math/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace fascia::app {

namespace {

template <class... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};
template <class... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;

/// Rounding must not decide whether a frame on a face is inside: a small part of the largest coordinate is forgiven.
double tolerance(const Vec3d& a, const Vec3d& b) { return 1e-9 * (norm(a) + norm(b)); }

bool in_box(const BoxRegion& b, const Vec3d& X) {
  const double t = tolerance(b.min, b.max);
  for (int a = 0; a < 3; ++a)
    if (X[a] < b.min[a] - t || X[a] > b.max[a] + t) return false;
  return true;
}

bool in_cylinder(const CylinderRegion& c, const Vec3d& X) {
  const Vec3d axis = c.to - c.from, d = X - c.from;
  const double length = norm(axis), along = dot(d, axis) / length;
  const double radius = norm(d - axis * (along / length));
  const double t = tolerance(c.from, c.to);
  return along >= -t && along <= length + t && radius <= c.radius + t;
}

int nearest_point(const Vec3d& target, std::span<const Vec3d> points) {
  int best = -1;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance = squared_norm(points[i] - target);
    if (distance < least * (1 - 1e-12)) {
      least = distance;
      best = static_cast<int>(i);
    }
  }
  return best;
}

[[noreturn]] void fail(const Region& region, const std::string& message) {
  throw SceneError({{region.place, message}});
}

/// Marks what a group of the mesh has: its nodes, or the points in its cells.
void select_group(const Region& region, const std::string& name, const Selectable& from, std::vector<bool>& chosen) {
  if (from.groups == nullptr)
    fail(region, "a meshless body has no mesh groups; select by box, sphere, cylinder or halfspace");
  std::vector<std::string> names;
  std::vector<const BodyGroup*> found;  // by name; else by number
  for (const BodyGroup& g : *from.groups) {
    names.push_back("\"" + g.name + "\"");
    if (g.name == name) found.push_back(&g);
  }
  if (found.empty())
    for (const BodyGroup& g : *from.groups)
      if (std::to_string(g.number) == name) found.push_back(&g);
  std::vector<char> marked;
  for (const BodyGroup* g : found) {
    const std::vector<int>& members = from.cell.empty() ? g->nodes : g->cells;
    if (!members.empty()) marked.resize(std::max(marked.size(), at(members.back()) + 1));
    for (const int member : members) marked[at(member)] = 1;
  }
  constexpr const char* kinds[] = {"of points", "of lines", "of surfaces", "of volumes"};
  if (from.cell.empty() && found.size() > 1)
    fail(region,
         fmt::format("\"{}\" means group \"{}\" {} and group \"{}\" {}; name one that is alone, or rename one", name,
                     found[0]->name, kinds[found[0]->dimension], found[1]->name, kinds[found[1]->dimension]));
  if (found.empty())
    fail(region, names.empty() ? "the mesh has no groups; select by box, sphere, cylinder or halfspace"
                               : fmt::format("the mesh has no group \"{}\"; it has {}", name, fmt::join(names, ", ")));
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const std::size_t member = from.cell.empty() ? i : at(from.cell[i]);
    chosen[i] = member < marked.size() && marked[member] != 0;
  }
}

}  // namespace

std::vector<bool> select(const Region& region, const Selectable& from) {
  const std::span<const Vec3d> points = from.points;
  const std::span<const char> on_boundary = from.on_boundary;
  std::vector<bool> chosen(points.size(), false);
  const auto by_position = [&](const auto& test) {
    for (std::size_t i = 0; i < points.size(); ++i) chosen[i] = test(points[i]);
  };
  const auto combine = [&](const std::vector<Region>& parts, bool all) {
    chosen.assign(points.size(), all);
    for (const Region& part : parts) {
      const std::vector<bool> other = select(part, from);
      for (std::size_t i = 0; i < points.size(); ++i) chosen[i] = all ? chosen[i] && other[i] : chosen[i] || other[i];
    }
  };
  std::visit(Overloaded{
                 [&](const AllRegion&) { chosen.assign(points.size(), true); },
                 [&](const BoundaryRegion&) {
                   if (on_boundary.empty())
                     fail(region, "boundary cannot be asked for here; use a box, sphere or cylinder");
                   for (std::size_t i = 0; i < points.size(); ++i) chosen[i] = on_boundary[i] != 0;
                 },
                 [&](const BoxRegion& b) { by_position([&](const Vec3d& X) { return in_box(b, X); }); },
                 [&](const SphereRegion& s) {
                   by_position([&](const Vec3d& X) { return norm(X - s.center) <= s.radius + tolerance(s.center, X); });
                 },
                 [&](const CylinderRegion& c) { by_position([&](const Vec3d& X) { return in_cylinder(c, X); }); },
                 [&](const HalfspaceRegion& h) {
                   by_position(
                       [&](const Vec3d& X) { return dot(X - h.point, normalized(h.normal)) <= tolerance(X, h.point); });
                 },
                 [&](const NearestRegion& n) {
                   if (const int i = nearest_point(n.point, points); i >= 0) chosen[static_cast<std::size_t>(i)] = true;
                 },
                 [&](const GroupRegion& g) { select_group(region, g.name, from, chosen); },
                 [&](const IdsRegion& ids) {
                   for (const int id : ids.ids) {
                     if (id < 0 || static_cast<std::size_t>(id) >= points.size())
                       fail(region,
                            "no node " + std::to_string(id) + "; must be 0 to " + std::to_string(points.size() - 1));
                     chosen[static_cast<std::size_t>(id)] = true;
                   }
                 },
                 [&](const AllOfRegion& r) { combine(r.parts, true); },
                 [&](const AnyOfRegion& r) { combine(r.parts, false); },
                 [&](const NotRegion& r) {
                   chosen = select(*r.part, from);
                   chosen.flip();
                 },
             },
             region.shape);
  return chosen;
}

namespace {

/// Whether a region, or any that it is made of, passes a test.
template <class Test>
bool any_part(const Region& region, const Test& test) {
  const auto in = [&](const Region& r) { return any_part(r, test); };
  if (const auto* all = std::get_if<AllOfRegion>(&region.shape))
    return std::any_of(all->parts.begin(), all->parts.end(), in);
  if (const auto* any = std::get_if<AnyOfRegion>(&region.shape))
    return std::any_of(any->parts.begin(), any->parts.end(), in);
  if (const auto* inner = std::get_if<NotRegion>(&region.shape)) return in(*inner->part);
  return test(region);
}

}  // namespace

void require_material(const Region& region) {
  any_part(region, [](const Region& r) {
    if (std::holds_alternative<NearestRegion>(r.shape) || std::holds_alternative<IdsRegion>(r.shape))
      fail(r, "nearest and ids select nodes, not material; use a box, sphere, cylinder or halfspace");
    return false;
  });
}

bool contains(const Region& region, const Vec3d& X) {
  require_material(region);
  return select(region, {std::span(&X, 1)})[0];
}

bool names_boundary(const Region& region) {
  return any_part(region, [](const Region& r) { return std::holds_alternative<BoundaryRegion>(r.shape); });
}

bool names_frames(const Region& region) {
  return any_part(region, [](const Region& r) {
    return std::holds_alternative<NearestRegion>(r.shape) || std::holds_alternative<IdsRegion>(r.shape);
  });
}

}  // namespace fascia::app
