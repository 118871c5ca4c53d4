#include "fascia/run/edge_bulges.hpp"

#include "core/base/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

namespace fascia {

namespace {

/// The bulge over the strain along the edge times side² / thickness, as the ends of inflated tubes have it: 0.28 to
/// 0.42 of 25 to 400 for R/t, at sides of 0.8 and 1.6 √(R t).
constexpr double kBulge = 0.28;
/// Sides over √(R t) from which a tube's edge widens by a tenth more than it should.
constexpr double kFineEnough = 0.6;
/// Bulges below this part of the body's largest displacement are not told.
constexpr double kSeen = 0.05;
/// A larger angle between triangles is a crease [rad].
constexpr double kCrease = 1.0;

/// A side of a triangle; at the rim no other one has it.
struct Rim {
  int from = 0, to = 0;
  std::size_t triangle = 0;
};

std::set<int> held_nodes(const Simulation& s) {
  std::set<int> held;
  for (const FrameConstraint& c : s.model.constraints) held.insert(c.node);
  for (const DependentNode& d : s.model.points.dependents) held.insert(d.node);
  for (const SimulatedBody& other : s.bodies)
    held.insert(other.body->shared_nodes().begin(), other.body->shared_nodes().end());
  return held;
}

std::vector<Rim> rim_of(const std::vector<std::vector<int>>& triangles) {
  std::vector<Rim> sides, rim;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) sides.push_back({triangles[t][k], triangles[t][(k + 1) % 3], t});
  const auto ends = [](const Rim& r) { return std::minmax({r.from, r.to}); };
  std::sort(sides.begin(), sides.end(), [&](const Rim& r, const Rim& o) { return ends(r) < ends(o); });
  for (std::size_t k = 0; k < sides.size();) {
    const std::size_t first = k;
    while (k < sides.size() && ends(sides[k]) == ends(sides[first])) ++k;
    if (k == first + 1) rim.push_back(sides[first]);
  }
  return rim;
}

}  // namespace

void warn_of_edge_bulges(const Simulation& s, const SimulatedBody& shell, const State& end, Warnings& warnings) {
  const std::vector<Vec3d>& X = shell.body->surface().points;
  const std::vector<std::vector<int>> triangles = shell.body->faces();
  const std::vector<Rim> rim = rim_of(triangles);
  if (rim.empty()) return;
  const std::set<int> held = held_nodes(s);
  const auto node = [&](int point) { return shell.node_ids[at(point)]; };
  const auto u = [&](int point) { return end.u[at(node(point))]; };
  const auto normal = [&](std::size_t t) {
    const std::vector<int>& f = triangles[t];
    return cross(X[at(f[1])] - X[at(f[0])], X[at(f[2])] - X[at(f[0])]);  // twice the area long
  };
  double largest = 0, bulge = 0, fine = 0;
  Vec3d where;
  for (std::size_t k = 0; k < X.size(); ++k) largest = std::max(largest, norm(u(static_cast<int>(k))));
  std::map<int, const Rim*> from;
  for (const Rim& r : rim) from[r.from] = &r;
  for (const Rim& r : rim) {
    const auto next = from.find(r.to);
    if (next == from.end() || held.contains(node(r.to))) continue;
    const Rim& n = *next->second;
    const Vec3d one = normal(r.triangle), other = normal(n.triangle);
    const double angle = std::atan2(norm(cross(one, other)), dot(one, other));
    const double length = norm(X[at(r.to)] - X[at(r.from)]) + norm(X[at(n.to)] - X[at(n.from)]), side = 0.5 * length;
    const double now = norm(X[at(r.to)] + u(r.to) - X[at(r.from)] - u(r.from)) +
                       norm(X[at(n.to)] + u(n.to) - X[at(n.from)] - u(n.from));
    const double thickness = shell.body->points()[r.triangle].volume / (0.5 * norm(one));
    const double size = std::sqrt(side * angle / thickness),
                 way = kBulge * std::abs(now / length - 1) * side * side / thickness;
    if (size < kFineEnough || angle > kCrease || way <= bulge) continue;
    bulge = way;
    where = X[at(r.to)];
    fine = 0.5 * side / size;
  }
  if (bulge > kSeen * largest)
    warnings.add(
        "resolution",
        fmt::format("body \"{}\": the edge near ({:.4g}, {:.4g}, {:.4g}), which nothing holds, bulges by about "
                    "{:.2g} m, {:.2g} of the largest displacement: its triangles are too large for the force "
                    "along it; take sides of {:.2g} m there, or hold it",
                    shell.name, where[0], where[1], where[2], bulge, bulge / largest, fine));
}

}  // namespace fascia
