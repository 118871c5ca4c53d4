#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/surface_edges.hpp"
#include "core/geometry/surface_parts.hpp"
#include "core/geometry/surface_touching.hpp"
#include "core/geometry/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fascia::surface_parts {
namespace {

std::string name_of(const Solid& solid, const Edge& edge) {
  return "nodes " + std::to_string(solid.point_file_number[static_cast<std::size_t>(edge.low)]) + " and " +
         std::to_string(solid.point_file_number[static_cast<std::size_t>(edge.high)]);
}

[[noreturn]] void fail_mixed(const Solid& solid, const std::vector<Triangle>& triangles, const Components& components) {
  if (!components.orientable)
    fail(solid, "its surface has one side only (at triangle " +
                    std::to_string(triangles[static_cast<std::size_t>(components.twisted)].file_number) +
                    "); give the closed surface of a solid");
  std::vector<std::size_t> size(static_cast<std::size_t>(components.count)), turned(size);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto c = static_cast<std::size_t>(components.of[t]);
    ++size[c];
    turned[c] += components.turn[t] ? 1u : 0u;
  }
  std::size_t first = triangles.size(), count = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto c = static_cast<std::size_t>(components.of[t]);
    const bool minority_turns = 2 * turned[c] <= size[c];
    if (turned[c] == 0 || components.turn[t] != minority_turns) continue;
    first = std::min(first, t);
    ++count;
  }
  fail(solid, "triangle " + std::to_string(triangles[first].file_number) +
                  " is oriented against its neighbours, as are " + std::to_string(count - 1) + " more of " +
                  std::to_string(triangles.size()) + " triangles; orient all of them outward");
}

/// One closed component: whether it is outward, and what a test of points needs.
struct Component {
  std::vector<Triangle> triangles;
  Bounds bounds;
  double volume = 0;  ///< negative where it faces inward
  bool outward = true;
};

std::vector<Component> split(const Solid& solid, const std::vector<Triangle>& triangles, const Components& components) {
  std::vector<Component> result(static_cast<std::size_t>(components.count));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    result[static_cast<std::size_t>(components.of[t])].triangles.push_back(triangles[t]);
  for (Component& component : result) {
    for (const Triangle& t : component.triangles)
      for (const int node : t.nodes) component.bounds.include(solid.points[static_cast<std::size_t>(node)]);
    component.volume = enclosed_volume(solid.points, component.triangles);
    component.outward = component.volume > 0;
  }
  return result;
}

/// The middle of a triangle with a node that is none of these, where there is one: it does not lie on what has them.
Vec3d place_of(const Solid& solid, const std::vector<Triangle>& triangles, const std::vector<bool>& nodes) {
  const auto apart = [&](const Triangle& t) {
    return std::ranges::any_of(t.nodes, [&](int node) { return !nodes[at(node)]; });
  };
  const auto found = std::ranges::find_if(triangles, apart);
  Vec3d x{};
  for (const int node : (found == triangles.end() ? triangles.front() : *found).nodes)
    x += solid.points[at(node)] * (1.0 / 3);
  return x;
}

/// For each component, in how many others it lies.
std::vector<int> nesting_depths(const Solid& solid, const std::vector<Component>& components) {
  std::vector<int> depth(components.size(), 0);
  for (std::size_t outer = 0; outer < components.size(); ++outer) {
    std::optional<InsideTest> test;
    std::vector<bool> nodes;  // of the outer one
    for (std::size_t inner = 0; inner < components.size(); ++inner) {
      if (inner == outer || !components[outer].bounds.contains(components[inner].bounds)) continue;
      if (!test) {
        test.emplace(compact(solid, components[outer].triangles));
        nodes.assign(solid.points.size(), false);
        for (const Triangle& t : components[outer].triangles)
          for (const int node : t.nodes) nodes[at(node)] = true;
      }
      if (test->winding_number(place_of(solid, components[inner].triangles, nodes)) != 0) ++depth[inner];
    }
  }
  return depth;
}

/// Looks at how often the surface surrounds what lies on lines along x: twice where parts overlap or one passes through
/// itself, inside out where it has folded through itself. What touches, or overlaps by what splits of curved faces
/// differ by, is left alone or told.
void check_overlaps(const Solid& solid, const std::vector<Triangle>& triangles, OfOverlap overlap,
                    std::vector<std::string>& messages) {
  constexpr int kLines = 48;                       // along y and z
  constexpr double kTold = 1e-3, kTooMuch = 0.02;  // of the volume
  const TriangleMesh mesh = compact(solid, triangles);
  const Bounds box = bounds_of(mesh.points);
  const InsideTest test(mesh);
  InsideTest::Surrounded sum;
  for (int j = 0; j < kLines; ++j)
    for (int k = 0; k < kLines; ++k) {
      const auto along = [&](int axis, int line) {
        return box.low[axis] + (line + 0.5) / kLines * (box.high[axis] - box.low[axis]);
      };
      const InsideTest::Surrounded line = test.surrounded(along(1, j), along(2, k));
      sum.inside += line.inside;
      sum.wrong += line.wrong;
    }
  if (sum.wrong <= kTold * sum.inside) return;
  const double percent = std::min(100.0, std::round(1000 * sum.wrong / sum.inside) / 10);
  const std::string what = "its surface intersects itself, and about " + message::text(percent) +
                           " % of what it encloses counts twice or not; unite what overlaps to one surface, or make a "
                           "body of each part";
  if (overlap == OfOverlap::is_refused && sum.wrong > kTooMuch * sum.inside) fail(solid, what);
  messages.push_back(solid.file + ": " + what);
}

/// A part of the sheet that hangs together across edges of two triangles.
struct Patch {
  std::vector<std::size_t> triangles;
  std::size_t disagreeing = 0;  ///< triangles that must turn to agree with the first
};

std::vector<Patch> split_sheet(const Components& components) {
  std::vector<Patch> patches(at(components.count));
  for (std::size_t t = 0; t < components.of.size(); ++t) {
    Patch& patch = patches[at(components.of[t])];
    patch.triangles.push_back(t);
    patch.disagreeing += components.turn[t] ? 1u : 0u;
  }
  return patches;
}

void turn_over(Triangle& triangle) { std::swap(triangle.nodes[1], triangle.nodes[2]); }

}  // namespace

void check_closed(const Solid& solid, const std::vector<Triangle>& triangles, std::vector<std::string>& messages) {
  const std::vector<Edge> edges = sorted_edges(triangles);
  std::size_t open = 0, first_open = 0, touching = 0, first_touching = 0;
  bool consistent = true;
  for (std::size_t e = edges.size(), begin = e; e > 0; e = begin) {
    for (begin = e; begin > 0 && edges[begin - 1].same_as(edges[e - 1]);) --begin;
    if (e - begin > 2 && !balanced(std::span(edges).subspan(begin, e - begin)))
      fail(solid, "the edge between " + name_of(solid, edges[begin]) + " belongs to " + std::to_string(e - begin) +
                      " triangles of the surface, which bound no solid there; remove what branches off or overlaps, "
                      "or give a volume mesh");
    if (e - begin > 2) {
      ++touching;
      first_touching = begin;
    } else if (e - begin == 1) {
      ++open;
      first_open = begin;
    } else if (edges[begin].forward == edges[begin + 1].forward) {
      consistent = false;
    }
  }
  if (open > 0)
    fail(solid, "its surface is open: " + std::to_string(open) + " edges have one triangle only, the first between " +
                    name_of(solid, edges[first_open]) + "; close the holes or give a volume mesh");
  if (!consistent) fail_mixed(solid, triangles, Components(Neighbours(triangles.size(), edges)));
  if (touching > 0)
    messages.push_back(solid.file + ": its surface touches itself along " + std::to_string(touching) +
                       (touching == 1 ? " edge, between " : " edges, the first between ") +
                       name_of(solid, edges[first_touching]) + "; the solid hangs together there");
}

namespace {

/// Pairs of components that touch along an edge, each in both orders.
std::set<std::array<int, 2>> joined_components(const std::vector<TouchingEdge>& touching, const Components& numbering) {
  std::set<std::array<int, 2>> joined;
  for (const TouchingEdge& edge : touching)
    for (const auto& p : edge.pairs)
      for (const auto& q : edge.pairs)
        if (const int a = numbering.of[at(p[0])], b = numbering.of[at(q[0])]; a != b) joined.insert({a, b});
  return joined;
}

/// Components that fold inward from the one around them, face outward, and hold next to nothing.
std::vector<bool> find_pockets(const std::vector<Component>& components, const std::vector<int>& depth,
                               const std::set<std::array<int, 2>>& joined) {
  constexpr double kSmall = 1e-3;  // of the volume around
  std::vector<bool> pockets(components.size(), false);
  for (const auto& [inner, outer] : joined) {
    const Component &in = components[at(inner)], &around = components[at(outer)];
    if (in.volume > 0 && in.volume < kSmall * std::abs(around.volume) && depth[at(inner)] % 2 != 0 &&
        depth[at(outer)] == depth[at(inner)] - 1)
      pockets[at(inner)] = true;
  }
  return pockets;
}

/// Leaves out what folds inward from the surface of a solid and faces outward: it bounds matter that is there already.
void leave_out(const Solid& solid, const std::vector<bool>& pockets, const Components& numbering,
               std::vector<Triangle>& triangles, std::vector<std::string>& messages) {
  std::vector<Triangle> left;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (!pockets[at(numbering.of[t])]) left.push_back(triangles[t]);
  if (left.size() == triangles.size()) return;
  messages.push_back(solid.file + ": left out " + std::to_string(triangles.size() - left.size()) +
                     " triangles of folds that lie inside the solid, touch its surface and face outward");
  triangles = std::move(left);
}

}  // namespace

void orient_outward(const Solid& solid, std::vector<Triangle>& triangles, std::vector<std::string>& messages) {
  Neighbours neighbours(triangles.size(), sorted_edges(triangles));
  const std::vector<TouchingEdge> touching = touching_edges(solid.points, triangles);
  for (const TouchingEdge& edge : touching)
    for (const auto& [a, b] : edge.pairs) neighbours.link(a, b);
  const Components numbering(neighbours);
  const std::vector<Component> components = split(solid, triangles, numbering);
  const std::vector<int> depth = nesting_depths(solid, components);
  const std::vector<bool> pockets = find_pockets(components, depth, joined_components(touching, numbering));
  std::size_t wrong = 0, first_wrong = 0, wrong_pockets = 0;
  for (std::size_t c = components.size(); c-- > 0;) {
    if (components[c].outward == (depth[c] % 2 == 0)) continue;
    ++wrong;
    if (pockets[c])
      ++wrong_pockets;
    else
      first_wrong = c;
  }
  // One that touches itself may close only with what it encloses twice.
  const OfOverlap overlap = components.size() > 1 ? OfOverlap::is_refused : OfOverlap::is_told;
  if (wrong == wrong_pockets) {
    leave_out(solid, pockets, numbering, triangles, messages);
    return check_overlaps(solid, triangles, overlap, messages);
  }
  if (wrong < components.size())
    fail(solid, "the closed part with triangle " + std::to_string(components[first_wrong].triangles[0].file_number) +
                    " is oriented against the others (" + std::to_string(wrong) + " of " +
                    std::to_string(components.size()) +
                    " parts); orient outer surfaces outward and those of cavities " + "inward");
  for (Triangle& t : triangles) std::swap(t.nodes[1], t.nodes[2]);
  messages.push_back(solid.file + ": all " + std::to_string(triangles.size()) + " triangles face inward; turned over");
  check_overlaps(solid, triangles, overlap, messages);
}

void turn_cavities(const Solid& solid, OfOverlap overlap, std::vector<Triangle>& triangles,
                   std::vector<std::string>& messages) {
  const Components numbering(Neighbours(triangles.size(), sorted_edges(triangles)));
  const std::vector<int> depth = nesting_depths(solid, split(solid, triangles, numbering));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (depth[at(numbering.of[t])] % 2 != 0) turn_over(triangles[t]);
  const auto cavities = std::ranges::count_if(depth, [](int d) { return d % 2 != 0; });
  if (cavities > 0)
    messages.push_back(solid.file + ": " + std::to_string(cavities) +
                       (cavities == 1 ? " closed part lies inside another and bounds a cavity"
                                      : " closed parts lie inside others and bound cavities"));
  check_overlaps(solid, triangles, numbering.count > 1 ? overlap : OfOverlap::is_told, messages);
}

void orient_sheet(const Solid& sheet, std::vector<Triangle>& triangles, std::vector<std::string>& messages) {
  const Components components(Neighbours(triangles.size(), sorted_edges(triangles)));
  if (!components.orientable)
    fail(sheet, "a sheet has one side only, as a Moebius strip (at triangle " +
                    std::to_string(triangles[at(components.twisted)].file_number) +
                    "); cut it open or give a sheet with two sides");
  std::size_t turned = 0, first = triangles.size(), inward = 0;
  for (const Patch& patch : split_sheet(components)) {
    const bool minority = 2 * patch.disagreeing <= patch.triangles.size();
    for (const std::size_t t : patch.triangles) {
      if (components.turn[t] != minority) continue;
      turn_over(triangles[t]);
      first = std::min(first, t);
      ++turned;
    }
    std::vector<Triangle> own;
    for (const std::size_t t : patch.triangles) own.push_back(triangles[t]);
    if (!encloses(own) || enclosed_volume(sheet.points, own) >= 0) continue;
    for (const std::size_t t : patch.triangles) turn_over(triangles[t]);
    ++inward;
  }
  if (turned > 0)
    messages.push_back(sheet.file + ": turned over " + std::to_string(turned) + " of " +
                       std::to_string(triangles.size()) +
                       " triangles of sheets that disagreed with their neighbours (the first: triangle " +
                       std::to_string(triangles[first].file_number) + ")");
  if (inward > 0)
    messages.push_back(sheet.file + ": turned over " + std::to_string(inward) + " closed sheets that faced inward");
}

}  // namespace fascia::surface_parts
