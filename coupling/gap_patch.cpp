#include "coupling/gap_patch.hpp"

#include "core/base/disjoint_sets.hpp"
#include "core/base/index.hpp"
#include "core/geometry/surface_edges.hpp"

#include <algorithm>
#include <map>

namespace fascia::gap_parts {

namespace {

using surface_parts::Components;
using surface_parts::Edge;
using surface_parts::for_each_edge;
using surface_parts::Neighbours;
using surface_parts::sorted_edges;

std::vector<Edge> edges_of(const GapPatch& patch) {
  std::vector<surface_parts::Triangle> triangles;
  for (const auto& t : patch.triangles) triangles.push_back({t, 0});
  return sorted_edges(triangles);
}

void add_point(GapPatch& patch, const Vec3d& X, const TriangleTree& tree) {
  patch.points.push_back(X);
  patch.feet.emplace_back();
  tree.distance(X, &patch.feet.back());
}

/// Neighbours agree, and each part that hangs together looks out of the gap.
void orient(GapPatch& patch) {
  const Components components(Neighbours(patch.triangles.size(), edges_of(patch)));
  for (std::size_t t = 0; t < patch.triangles.size(); ++t)
    if (components.turn[t]) std::swap(patch.triangles[t][1], patch.triangles[t][2]);
  std::vector<double> volume(at(components.count));
  for (std::size_t t = 0; t < patch.triangles.size(); ++t) volume[at(components.of[t])] += prism_volume(patch, t);
  for (std::size_t t = 0; t < patch.triangles.size(); ++t)
    if (volume[at(components.of[t])] < 0) std::swap(patch.triangles[t][1], patch.triangles[t][2]);
}

/// Middle points of edges to cut, by their ends.
using Cuts = std::map<std::pair<int, int>, int>;

/// Parts of a triangle some of whose edges are cut. Where two are, the quadrilateral's diagonal starts at the middle
/// that comes first around: a choice that no numbering changes.
void cut_triangle(const std::array<int, 3>& t, const Cuts& cuts, std::vector<std::array<int, 3>>& out) {
  std::array<int, 3> middle{};
  std::size_t count = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto cut = cuts.find(std::minmax(t[k], t[(k + 1) % 3]));
    middle[k] = cut == cuts.end() ? -1 : cut->second;
    count += middle[k] >= 0 ? 1 : 0;
  }
  if (count == 0) out.push_back(t);
  if (count == 3) {
    for (std::size_t k = 0; k < 3; ++k) out.push_back({t[k], middle[k], middle[(k + 2) % 3]});
    out.push_back(middle);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const int a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3], m = middle[k], n = middle[(k + 1) % 3];
    if (count == 1 && m >= 0) {
      out.push_back({a, m, c});
      out.push_back({m, b, c});
    }
    if (count == 2 && m >= 0 && n >= 0) {
      out.push_back({m, b, n});
      out.push_back({m, n, c});
      out.push_back({m, c, a});
    }
  }
}

void cut(GapPatch& patch, const Cuts& cuts) {
  std::vector<std::array<int, 3>> triangles;
  for (const auto& t : patch.triangles) cut_triangle(t, cuts, triangles);
  patch.triangles = std::move(triangles);
}

/// All triangles lie in one plane, to a part of the size.
bool plane(const CheckedSides& sides) {
  Vec3d normal;
  for (std::size_t t = 0; t < sides.second.triangles.size(); ++t) {
    const Vec3d n = double_area(sides.second, t);
    if (squared_norm(n) > squared_norm(normal)) normal = n;
  }
  if (!(squared_norm(normal) > 0)) return false;
  normal = normalized(normal);
  return std::all_of(sides.second.points.begin(), sides.second.points.end(), [&](const Vec3d& X) {
    return std::abs(dot(X - sides.second.points[0], normal)) < sides.touching;
  });
}

/// Cuts the edges that are too long to follow the second side. Returns whether there were any.
bool refine(GapPatch& patch, const CheckedSides& sides, bool curved, double longest) {
  constexpr double most_sag = 0.002;  // of an edge's foot [part of the gap]
  Cuts cuts;
  for_each_edge(edges_of(patch), [&](std::span<const Edge> same) {
    const int a = same[0].low, b = same[0].high;
    const double length = norm(patch.points[at(b)] - patch.points[at(a)]);
    if (length <= longest) return;
    const Vec3d X = (patch.points[at(a)] + patch.points[at(b)]) * 0.5;
    Vec3d foot;
    const double gap = sides.to_second.distance(X, &foot);
    const Vec3d straight = (patch.feet[at(a)] + patch.feet[at(b)]) * 0.5;
    const bool short_edge = !curved || length <= 0.5 * gap;
    if (short_edge && norm(foot - straight) <= std::max(most_sag * gap, sides.touching)) return;
    cuts[{a, b}] = static_cast<int>(patch.points.size());
    patch.points.push_back(X);
    patch.feet.push_back(foot);
  });
  cut(patch, cuts);
  return !cuts.empty();
}

}  // namespace

double prism_volume(const GapPatch& patch, std::size_t triangle) {
  const auto [a, b, c] = patch.triangles[triangle];
  const auto line = [&](int i) { return patch.feet[at(i)] - patch.points[at(i)]; };
  const Vec3d e = patch.points[at(b)] - patch.points[at(a)], f = patch.points[at(c)] - patch.points[at(a)],
              de = line(b) - line(a), df = line(c) - line(a);
  const Vec3d area = (cross(e, f) + (cross(e, df) + cross(de, f)) * 0.5 + cross(de, df) * (1.0 / 3)) * 0.5;
  return -dot(line(a) + line(b) + line(c), area) / 3;
}

GapPatch gap_patch(const CheckedSides& sides) {
  constexpr int most_cuts = 6;     // of an edge, in halves
  constexpr double margin = 1.01;  // edges as long as the second side's are not cut, whatever the rounding
  GapPatch patch;
  for (const Vec3d& X : sides.first.points) add_point(patch, X, sides.to_second);
  patch.triangles = sides.first.triangles;
  orient(patch);
  const bool curved = !plane(sides);
  const double longest = margin * mean_edge(sides.second);
  for (int k = 0; k < most_cuts; ++k)
    if (!refine(patch, sides, curved, longest)) break;
  orient(patch);  // corners that touch may have hidden before where the gap is
  return patch;
}

double drop_touching(GapPatch& patch, double tolerance) {
  double all = 0, dropped = 0;
  std::vector<std::array<int, 3>> kept;
  for (std::size_t t = 0; t < patch.triangles.size(); ++t) {
    const auto& nodes = patch.triangles[t];
    const Vec3d& a = patch.points[at(nodes[0])];
    const double area = 0.5 * norm(cross(patch.points[at(nodes[1])] - a, patch.points[at(nodes[2])] - a));
    const bool touches = std::all_of(nodes.begin(), nodes.end(), [&](int i) { return patch.gap(i) < tolerance; });
    all += area;
    if (touches || std::abs(prism_volume(patch, t)) <= tolerance * area)
      dropped += area;
    else
      kept.push_back(nodes);
  }
  patch.triangles = std::move(kept);
  return all > 0 ? dropped / all : 0;
}

std::vector<std::array<int, 2>> rim(const GapPatch& patch) {
  std::vector<std::array<int, 2>> free;
  for_each_edge(edges_of(patch), [&](std::span<const Edge> same) {
    if (same.size() == 2) return;
    for (const Edge& e : same)
      free.push_back(e.forward ? std::array<int, 2>{e.low, e.high} : std::array<int, 2>{e.high, e.low});
  });
  return free;
}

void separate(GapPatch& patch, const CheckedSides& sides) {
  // Corners of triangles that hang together across edges are one vertex.
  const std::size_t count = 3 * patch.triangles.size();
  DisjointSets corners(static_cast<int>(count));
  const auto corner = [&](int t, int node) {
    const auto& nodes = patch.triangles[at(t)];
    return 3 * t + static_cast<int>(std::find(nodes.begin(), nodes.end(), node) - nodes.begin());
  };
  for_each_edge(edges_of(patch), [&](std::span<const Edge> same) {
    if (same.size() != 2) return;
    for (const int node : {same[0].low, same[0].high})
      corners.join(corner(same[0].triangle, node), corner(same[1].triangle, node));
  });
  GapPatch own;
  std::vector<int> number(count, -1);
  own.triangles = patch.triangles;
  for (std::size_t t = 0; t < patch.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      int& n = number[at(corners.root(static_cast<int>(3 * t + k)))];
      if (n < 0) {
        n = static_cast<int>(own.points.size());
        own.points.push_back(patch.points[at(patch.triangles[t][k])]);
        own.feet.push_back(patch.feet[at(patch.triangles[t][k])]);
      }
      own.triangles[t][k] = n;
    }
  patch = std::move(own);

  std::vector<char> closes(patch.points.size(), 0);
  for (const auto& edge : rim(patch))
    for (const int node : edge) closes[at(node)] = patch.gap(node) < sides.touching ? 1 : 0;
  Cuts cuts;
  for_each_edge(edges_of(patch), [&](std::span<const Edge> same) {
    const int a = same[0].low, b = same[0].high;
    if (same.size() != 2 || closes[at(a)] == 0 || closes[at(b)] == 0) return;
    cuts[{a, b}] = static_cast<int>(patch.points.size());
    add_point(patch, (patch.points[at(a)] + patch.points[at(b)]) * 0.5, sides.to_second);
  });
  cut(patch, cuts);
}

}  // namespace fascia::gap_parts
