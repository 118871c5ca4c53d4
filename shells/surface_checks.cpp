#include "shells/surface_checks.hpp"

#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/geometry/surface_edges.hpp"
#include "core/geometry/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace fascia {
namespace {

using message::text;
using surface_parts::Edge;

constexpr double degree = std::numbers::pi / 180;
constexpr double worst_sound_aspect = 20, crease = 60 * degree, fold = 150 * degree;

const Vec3d& corner(const ShellMesh& mesh, std::size_t t, std::size_t n) {
  return mesh.nodes[at(mesh.triangles[t][n % 3])];
}

/// Normal of twice the triangle's area.
Vec3d double_area(const ShellMesh& mesh, std::size_t t) {
  return cross(corner(mesh, t, 1) - corner(mesh, t, 0), corner(mesh, t, 2) - corner(mesh, t, 0));
}

std::array<double, 3> edge_lengths(const ShellMesh& mesh, std::size_t t) {
  std::array<double, 3> lengths{};
  for (std::size_t n = 0; n < 3; ++n) lengths[n] = norm(corner(mesh, t, n + 1) - corner(mesh, t, n));
  return lengths;
}

std::vector<Edge> edges_of(const ShellMesh& mesh) {
  std::vector<surface_parts::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& nodes : mesh.triangles) triangles.push_back({nodes, 0});
  return surface_parts::sorted_edges(triangles);
}

/// Calls act(edge, first triangle, second triangle, angle between their normals) for all edges of two triangles. The
/// angle is positive where the surface turns away from its normals.
template <class Act>
void for_each_bend(const ShellMesh& mesh, const Act& act) {
  const std::vector<Edge> edges = edges_of(mesh);
  for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
    if (!edges[e].same_as(edges[e + 1])) continue;
    const Edge& edge = edges[e].forward ? edges[e] : edges[e + 1];
    const Edge& other = edges[e].forward ? edges[e + 1] : edges[e];
    const Vec3d a = double_area(mesh, at(edge.triangle)), b = double_area(mesh, at(other.triangle));
    const Vec3d along = mesh.nodes[at(edge.high)] - mesh.nodes[at(edge.low)];
    act(along, at(edge.triangle), at(other.triangle), std::atan2(dot(cross(a, b), along) / norm(along), dot(a, b)));
  }
}

/// A symmetric tensor in the plane of a triangle: axes along its first edge and normal to that.
struct PlaneTensor {
  double xx = 0, xy = 0, yy = 0;
  double largest() const { return std::abs(xx + yy) / 2 + std::hypot((xx - yy) / 2, xy); }
};

/// Largest curvature of each triangle by amount [1/m].
std::vector<double> curvatures(const ShellMesh& mesh) {
  std::vector<PlaneTensor> tensors(mesh.triangles.size());
  const auto add = [&](std::size_t t, const Vec3d& edge, double angle) {
    const Vec3d normal = double_area(mesh, t), first = normalized(corner(mesh, t, 1) - corner(mesh, t, 0));
    const double x = dot(edge, first), y = dot(edge, cross(normalized(normal), first));
    const double factor = angle / (norm(edge) * norm(normal));  // ½ θ l / A, edges not yet of length one
    tensors[t].xx += factor * x * x;
    tensors[t].xy += factor * x * y;
    tensors[t].yy += factor * y * y;
  };
  for_each_bend(mesh, [&](const Vec3d& edge, std::size_t a, std::size_t b, double angle) {
    if (std::abs(angle) >= crease) return;
    add(a, edge, angle);
    add(b, edge, angle);
  });
  std::vector<double> result;
  result.reserve(tensors.size());
  for (const PlaneTensor& tensor : tensors) result.push_back(tensor.largest());
  return result;
}

/// Counts what is too large, and finds where most.
struct Worst {
  double value = 0;
  std::size_t triangle = 0, count = 0;
  void look(double ratio, double limit, std::size_t t) {
    if (!(ratio > limit)) return;
    ++count;
    if (ratio > value) value = ratio, triangle = t;
  }
  std::string of(const ShellMesh& mesh) const {
    return std::to_string(count) + " of " + std::to_string(mesh.triangles.size()) + " triangles";
  }
};

std::string prefix(const ShellMesh& mesh) { return mesh.file.empty() ? "" : mesh.file + ": "; }

}  // namespace

double area(const ShellMesh& mesh, std::size_t triangle) { return norm(double_area(mesh, triangle)) / 2; }

double area(const ShellMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) sum += area(mesh, t);
  return sum;
}

Vec3d middle(const ShellMesh& mesh, std::size_t t) {
  return (corner(mesh, t, 0) + corner(mesh, t, 1) + corner(mesh, t, 2)) * (1.0 / 3);
}

std::string name_of(const ShellMesh& mesh, std::size_t t) {
  const auto number = mesh.file_number.empty() ? static_cast<std::int64_t>(t) : mesh.file_number[t];
  return "triangle " + std::to_string(number) + " at " + text(middle(mesh, t));
}

ShellQuality shell_quality(const ShellMesh& mesh) {
  ShellQuality q;
  q.area = area(mesh);
  Worst slender, folded;
  double shortest = norm(corner(mesh, 0, 1) - corner(mesh, 0, 0)), longest = shortest;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto lengths = edge_lengths(mesh, t);
    const auto [low, high] = std::minmax_element(lengths.begin(), lengths.end());
    shortest = std::min(shortest, *low);
    longest = std::max(longest, *high);
    const double aspect = *high * *high / (2 * area(mesh, t));
    slender.look(aspect, worst_sound_aspect, t);
    if (aspect > q.worst_aspect) q.worst_aspect = aspect, q.worst = t;
  }
  for_each_bend(mesh,
                [&](const Vec3d&, std::size_t a, std::size_t, double angle) { folded.look(std::abs(angle), fold, a); });
  q.sentence = std::to_string(mesh.triangles.size()) + " triangles on " + std::to_string(mesh.nodes.size()) +
               " nodes, " + (closed(mesh) ? "closed" : "open") + ": area " + text(q.area) + " m2, edges from " +
               text(shortest) + " to " + text(longest) + " m, longest edge over height at most " +
               text(q.worst_aspect) + " (" + name_of(mesh, q.worst) + ")";
  if (slender.count > 0)
    q.messages.push_back(prefix(mesh) + slender.of(mesh) + " are needles or caps (longest edge over height above 20; " +
                         "the worst, " + text(slender.value) + ": " + name_of(mesh, slender.triangle) +
                         "); they are too stiff and slow the solver down, mesh again");
  if (folded.count > 0)
    q.messages.push_back(prefix(mesh) + "the surface folds back on itself at " + std::to_string(folded.count) +
                         (folded.count > 1 ? " edges" : " edge") + " (the sharpest: " + name_of(mesh, folded.triangle) +
                         "); mesh again");
  const ShellParts parts = parts_of(mesh);
  if (parts.count > 1)
    q.messages.push_back(prefix(mesh) + "falls into " + std::to_string(parts.count) + " parts that share no node");
  if (!parts.pinched.empty())
    q.messages.push_back(prefix(mesh) + "parts of the surface meet in single nodes (" +
                         std::to_string(parts.pinched.size()) + ", the first at " +
                         text(mesh.nodes[at(parts.pinched.front())]) + "); they are joined there by one frame");
  return q;
}

std::vector<std::string> thickness_warnings(const ShellMesh& mesh, const std::vector<double>& thickness) {
  Bounds bounds = bounds_of(mesh.nodes);
  const double most = *std::max_element(thickness.begin(), thickness.end());
  if (most > 0.5 * bounds.diagonal())
    return {"is " + text(most) + " m thick and " + text(bounds.diagonal()) +
            " m across; write lengths with their unit, as \"2 mm\""};
  const std::vector<double> curvature = curvatures(mesh);
  Worst curved, coarse;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto lengths = edge_lengths(mesh, t);
    curved.look(thickness[t] * curvature[t], 1, t);
    coarse.look(3 * thickness[t] / (lengths[0] + lengths[1] + lengths[2]), 1, t);
  }
  std::vector<std::string> warnings;
  if (curved.count > 0)
    warnings.push_back("the thickness is above the radius of curvature of " + curved.of(mesh) + " (the worst, " +
                       text(thickness[curved.triangle]) + " m above " + text(1 / curvature[curved.triangle]) +
                       " m: " + name_of(mesh, curved.triangle) + "); a shell must be thin against its radius");
  if (coarse.count > 0)
    warnings.push_back("the thickness is above the length of the edges of " + coarse.of(mesh) + " (the worst, " +
                       text(coarse.value) + " times: " + name_of(mesh, coarse.triangle) +
                       "); a shell gains nothing from edges shorter than it is thick, use fewer cells or tetrahedra");
  return warnings;
}

}  // namespace fascia
