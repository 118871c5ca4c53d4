#include "coupling/gap_sides.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/text.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::gap_parts {

namespace {

using message::text;

/// Distance [relative to the sides' size] within which sides touch, and bodies do not overlap yet.
constexpr double kTouching = 1e-6;

/// Cosine of 80°: a line that leaves an open side flatter does not go across the gap.
constexpr double kFlattest = 0.17364817766693035;

std::string quoted(const std::string& body) { return "\"" + body + "\""; }

/// The triangles on the points that they use, in the same order.
TriangleMesh compact(const TriangleMesh& mesh) {
  std::vector<int> place(mesh.points.size(), -1);
  for (const auto& t : mesh.triangles)
    for (const int node : t) place[at(node)] = 0;
  TriangleMesh used;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] < 0) continue;
    place[i] = static_cast<int>(used.points.size());
    used.points.push_back(mesh.points[i]);
  }
  for (const auto& t : mesh.triangles) used.triangles.push_back({place[at(t[0])], place[at(t[1])], place[at(t[2])]});
  return used;
}

void check_faces(const GapSide& side) {
  if (side.whole.triangles.empty())
    throw InputError("body " + quoted(side.body) +
                     " has no faces between which a space could lie, as lines have none; couple it by frames.share or "
                     "[couplings.NAME]");
  if (side.faces.triangles.empty())
    throw InputError("where selects no face of the surface of body " + quoted(side.body) +
                     "; a face counts when all its vertices are selected");
}

/// No vertex of a side's faces lies deep in the other body.
void check_overlap(const TriangleMesh& faces, const std::string& body, const GapSide& other, double tolerance) {
  if (!other.closed) return;
  const InsideTest inside(other.whole);
  double deepest = tolerance;
  const Vec3d* place = nullptr;
  for (const Vec3d& X : faces.points) {
    if (!inside.contains(X)) continue;
    const double depth = inside.distance(X);
    if (depth <= deepest) continue;
    deepest = depth;
    place = &X;
  }
  if (place)
    throw InputError("bodies " + quoted(body) + " and " + quoted(other.body) + " overlap: the vertex of " +
                     quoted(body) + " at " + text(*place) + " lies " + text(deepest) + " m inside " +
                     quoted(other.body) + "; move them apart, or select only what lies outside");
}

/// The line from a side leaves it: against the normal of a closed one it runs through the body.
bool leaves(const Vec3d& line, const Vec3d& normal, bool closed) {
  const double across = dot(line, normal);
  return closed ? across > 0 : std::abs(across) > kFlattest * norm(line) * norm(normal);
}

/// Most of the area that does not touch is joined by lines that leave the sides.
void check_facing(const CheckedSides& sides, bool first_closed, bool second_closed) {
  double area = 0, leaving_first = 0, leaving_second = 0;
  for (std::size_t t = 0; t < sides.first.triangles.size(); ++t) {
    Vec3d middle, foot;
    for (const int node : sides.first.triangles[t]) middle += sides.first.points[at(node)] * (1.0 / 3);
    int nearest = 0;
    if (sides.to_second.distance(middle, &foot, &nearest) < sides.touching) continue;
    const Vec3d normal = double_area(sides.first, t);
    const double here = norm(normal);
    area += here;
    if (leaves(foot - middle, normal, first_closed)) leaving_first += here;
    if (leaves(middle - foot, double_area(sides.second, at(nearest)), second_closed)) leaving_second += here;
  }
  if (std::min(leaving_first, leaving_second) < 0.5 * area) fail_facing(sides.first_body, sides.second_body);
}

}  // namespace

void fail_facing(const std::string& first_body, const std::string& second_body) {
  throw InputError("the selected parts of bodies " + quoted(first_body) + " and " + quoted(second_body) +
                   " do not face each other: the shortest lines between them run through a body or along a surface; "
                   "select with where only the parts between which the space lies");
}

void fail_touching(const std::string& first_body, const std::string& second_body) {
  throw InputError("the selected parts of bodies " + quoted(first_body) + " and " + quoted(second_body) +
                   " touch everywhere: there is no space between them; couple the bodies, or move them apart");
}

Vec3d double_area(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const Vec3d& a = mesh.points[at(t[0])];
  return cross(mesh.points[at(t[1])] - a, mesh.points[at(t[2])] - a);
}

double mean_edge(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) sum += norm(mesh.points[at(t[(k + 1) % 3])] - mesh.points[at(t[k])]);
  return sum / (3.0 * static_cast<double>(mesh.triangles.size()));
}

CheckedSides checked_sides(const GapSide& first, const GapSide& second) {
  check_faces(first);
  check_faces(second);
  TriangleMesh a = compact(first.faces), b = compact(second.faces);
  const TriangleTree tree(b);
  CheckedSides sides{std::move(a), std::move(b), tree, first.body, second.body};
  sides.size = std::max(bounds_of(sides.first.points).diagonal(), bounds_of(sides.second.points).diagonal());
  sides.touching = kTouching * sides.size;
  check_overlap(sides.first, first.body, second, sides.touching);
  check_overlap(sides.second, second.body, first, sides.touching);
  check_facing(sides, first.closed, second.closed);
  return sides;
}

}  // namespace fascia::gap_parts
