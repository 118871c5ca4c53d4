#include "assembly/simulation/regions.hpp"

#include "assembly/specification/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/math/precise_sum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace fascia {

namespace {

template <class... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};
template <class... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;

/// Rounding must not decide whether a frame on a face is inside: a small part of the body's size is forgiven, and what
/// coordinates far from the origin are rounded to. How large the region is does not count: a generous one selects the
/// same. Signed distances are sums of products with twice the digits of a double, in which a sphere of 1e15 m that
/// touches a body of 1 mm keeps 12 digits of the body's size; but its own centre and radius are doubles, which far out
/// are 0.1 m apart, and what they were rounded to is what counts.
class Forgiving {
 public:
  explicit Forgiving(double size) : part_(1e-9 * size) {}
  double at(const Vec3d& X) const {
    constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
    return part_ + rounding * norm(X);
  }

 private:
  double part_;
};

bool in_box(const BoxRegion& b, const Vec3d& X, double t) {
  for (int a = 0; a < 3; ++a)
    if (X[a] < b.min[a] - t || X[a] > b.max[a] + t) return false;
  return true;
}

/// |X − c|² − r² over |X − c| + r.
bool in_sphere(const SphereRegion& s, const Vec3d& X, double t) {
  PreciseSum excess;
  excess.add(-s.radius, s.radius);
  for (int a = 0; a < 3; ++a) excess.add(X[a], X[a]).add(-2 * X[a], s.center[a]).add(s.center[a], s.center[a]);
  return excess.value() <= t * (norm(X - s.center) + s.radius);
}

/// (X − p) · n over |n|.
bool in_halfspace(const HalfspaceRegion& h, const Vec3d& X, double t) {
  PreciseSum height;
  for (int a = 0; a < 3; ++a) height.add(X[a], h.normal[a]).add(-h.point[a], h.normal[a]);
  return height.value() <= t * norm(h.normal);
}

/// (X − end) · (to − from): above 0 beyond an end, over the length the distance from it.
double along_axis(const CylinderRegion& c, const Vec3d& X, const Vec3d& end) {
  PreciseSum sum;
  for (int a = 0; a < 3; ++a) sum.add(X[a], c.to[a]).add(-X[a], c.from[a]).add(-end[a], c.to[a]).add(end[a], c.from[a]);
  return sum.value();
}

/// |(X − from) × (to − from)| = |X × to − X × from − from × to|, over the length the distance from the axis.
Vec3d across_axis(const CylinderRegion& c, const Vec3d& X) {
  Vec3d moment;
  for (int a = 0; a < 3; ++a) {
    const int i = (a + 1) % 3, j = (a + 2) % 3;
    PreciseSum sum;
    sum.add(X[i], c.to[j]).add(-X[j], c.to[i]).add(-X[i], c.from[j]).add(X[j], c.from[i]);
    moment[a] = sum.add(-c.from[i], c.to[j]).add(c.from[j], c.to[i]).value();
  }
  return moment;
}

bool in_cylinder(const CylinderRegion& c, const Vec3d& X, double t) {
  const double length = norm(c.to - c.from);
  return along_axis(c, X, c.from) >= -t * length && along_axis(c, X, c.to) <= t * length &&
         norm(across_axis(c, X)) <= (c.radius + t) * length;
}

/// |Y − p| − |X − p|: how much nearer X is.
double nearer_by(const NearestRegion& n, const Vec3d& X, const Vec3d& Y) {
  PreciseSum sum;
  for (int a = 0; a < 3; ++a) sum.add(Y[a], Y[a]).add(-X[a], X[a]).add(-2 * Y[a], n.point[a]).add(2 * X[a], n.point[a]);
  const double both = norm(X - n.point) + norm(Y - n.point);
  return both > 0 ? sum.value() / both : 0.0;
}

/// The first of those that are nearest but for what is forgiven.
int nearest_point(const NearestRegion& n, std::span<const Vec3d> points, const Forgiving& forgiving) {
  int best = -1;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (best < 0 || nearer_by(n, points[i], points[at(best)]) > forgiving.at(points[i])) best = static_cast<int>(i);
  return best;
}

[[noreturn]] void fail(const Region& region, const std::string& message) {
  throw SceneError({{region.place, message}});
}

/// Marks what a group of the mesh has: its nodes, or the points in its cells.
void select_group(const Region& region, const std::string& name, const Selectable& from, std::vector<bool>& chosen) {
  if (from.groups == nullptr)
    fail(region,
         "only bodies of elements and shells keep the groups of a mesh, and this body is none of them; select by box, "
         "sphere, cylinder or halfspace");
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

namespace {

std::vector<bool> select(const Region& region, const Selectable& from, const Forgiving& forgiving) {
  const std::span<const Vec3d> points = from.points;
  const std::span<const char> on_boundary = from.on_boundary;
  std::vector<bool> chosen(points.size(), false);
  const auto by_position = [&](const auto& inside, const auto& shape) {
    for (std::size_t i = 0; i < points.size(); ++i) chosen[i] = inside(shape, points[i], forgiving.at(points[i]));
  };
  const auto combine = [&](const std::vector<Region>& parts, bool all) {
    chosen.assign(points.size(), all);
    for (const Region& part : parts) {
      const std::vector<bool> other = select(part, from, forgiving);
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
                 [&](const BoxRegion& b) { by_position(in_box, b); },
                 [&](const SphereRegion& s) { by_position(in_sphere, s); },
                 [&](const CylinderRegion& c) { by_position(in_cylinder, c); },
                 [&](const HalfspaceRegion& h) { by_position(in_halfspace, h); },
                 [&](const NearestRegion& n) {
                   if (const int i = nearest_point(n, points, forgiving); i >= 0)
                     chosen[static_cast<std::size_t>(i)] = true;
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
                   chosen = select(*r.part, from, forgiving);
                   chosen.flip();
                 },
             },
             region.shape);
  return chosen;
}

}  // namespace

std::vector<bool> select(const Region& region, const Selectable& from) {
  return select(region, from, Forgiving(std::max(from.size, bounds_of(from.points).diagonal())));
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

bool contains(const Region& region, const Vec3d& X, double size) {
  require_material(region);
  return select(region, {.points = std::span(&X, 1), .size = size})[0];
}

bool names_boundary(const Region& region) {
  return any_part(region, [](const Region& r) { return std::holds_alternative<BoundaryRegion>(r.shape); });
}

bool names_frames(const Region& region) {
  return any_part(region, [](const Region& r) {
    return std::holds_alternative<NearestRegion>(r.shape) || std::holds_alternative<IdsRegion>(r.shape);
  });
}

bool names_ids(const Region& region) {
  return any_part(region, [](const Region& r) { return std::holds_alternative<IdsRegion>(r.shape); });
}

}  // namespace fascia
