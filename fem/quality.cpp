#include "fem/quality.hpp"

#include "core/base/index.hpp"
#include "fem/element_mesh_parts.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace fascia {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Extremes over the corners of one element.
struct CornerFigures {
  double least_cosine = 1, greatest_cosine = -1;  ///< of dihedral angles
  double jacobian = infinite, height = infinite, ratio = infinite;
};

/// 0 where the denominator is.
double ratio(double a, double b) { return b > 0 ? a / b : 0; }

/// 3 det(A)^⅔/|A|² of the edges at a corner, of tetrahedra mapped to a regular one.
double mean_ratio(std::array<Vec3d, 3> edge, bool tetrahedron) {
  if (tetrahedron) {  // columns of [a b c] W⁻¹, W the edges of a regular tetrahedron at a corner
    const double third = 1 / std::sqrt(3.0);
    edge[2] = (edge[2] * 3.0 - edge[1] - edge[0]) * std::sqrt(1.0 / 6);
    edge[1] = (edge[1] * 2.0 - edge[0]) * third;
  }
  const double det = dot(edge[0], cross(edge[1], edge[2]));
  const double squares = squared_norm(edge[0]) + squared_norm(edge[1]) + squared_norm(edge[2]);
  return det > 0 ? 3 * std::pow(det, 2.0 / 3) / squares : 0;
}

CornerFigures corner_figures(const ElementMesh& mesh, std::size_t e) {
  CornerFigures figures;
  const auto nodes = mesh.element(e);
  const auto neighbours = corner_neighbours(family_of(mesh.shape));
  for (std::size_t corner = 0; corner < neighbours.size(); ++corner) {
    std::array<Vec3d, 3> edge, normal;  // normal[k] is across from edge[k]
    for (std::size_t k = 0; k < 3; ++k)
      edge[k] = mesh.nodes[at(nodes[at(neighbours[corner][k])])] - mesh.nodes[at(nodes[corner])];
    for (std::size_t k = 0; k < 3; ++k) normal[k] = cross(edge[(k + 1) % 3], edge[(k + 2) % 3]);
    const double det = dot(edge[0], normal[0]);
    figures.jacobian = std::min(figures.jacobian, ratio(det, norm(edge[0]) * norm(edge[1]) * norm(edge[2])));
    figures.ratio = std::min(figures.ratio, mean_ratio(edge, neighbours.size() == 4));
    for (std::size_t k = 0; k < 3; ++k) {
      figures.height = std::min(figures.height, ratio(std::abs(det), norm(normal[k])));
      // The faces at edge k have the normals n_(k+1) and n_(k+2), both outward or both inward.
      const Vec3d &a = normal[(k + 1) % 3], &b = normal[(k + 2) % 3];
      const double cosine = std::clamp(-ratio(dot(a, b), norm(a) * norm(b)), -1.0, 1.0);
      figures.least_cosine = std::min(figures.least_cosine, cosine);
      figures.greatest_cosine = std::max(figures.greatest_cosine, cosine);
    }
  }
  return figures;
}

double degrees(double cosine) { return std::acos(cosine) * 180 / std::numbers::pi; }

std::string text(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.3g", value);
  return buffer.data();
}

std::string text(const WorstElement& worst, const char* unit = "") {
  return text(worst.value) + unit + " (element " + std::to_string(worst.number) + ")";
}

std::string place_text(const Vec3d& x) { return "(" + text(x[0]) + ", " + text(x[1]) + ", " + text(x[2]) + ")"; }

std::string sentence_of(const ElementMesh& mesh, const MeshQuality& q) {
  const bool tetrahedra = family_of(mesh.shape) == ElementFamily::tetrahedra;
  std::string sentence = std::to_string(mesh.size()) + (order_of(mesh.shape) == 2 ? " quadratic" : "") +
                         (tetrahedra ? " tetrahedra" : " hexahedra") + " on " + std::to_string(mesh.nodes.size()) +
                         " nodes: dihedral angles from " + text(q.least_dihedral) + " to " +
                         text(q.greatest_dihedral, " degrees") + ", smallest volume " + text(q.least_volume) +
                         " of the mean";
  if (!tetrahedra) sentence += ", smallest scaled Jacobian " + text(q.least_jacobian);
  return sentence + ", shortest height " + text(q.shortest_height, " m") + ", least mean ratio " +
         text(q.least_ratio.value) + " (element " + std::to_string(q.least_ratio.number) + " at " +
         place_text(q.least_ratio.middle) + ")";
}

}  // namespace

MeshQuality mesh_quality(const ElementMesh& mesh) {
  assert(mesh.size() > 0);
  MeshQuality q;
  q.least_dihedral.value = q.least_volume.value = q.least_jacobian.value = q.shortest_height.value =
      q.least_ratio.value = infinite;
  q.greatest_dihedral.value = -infinite;
  std::size_t folded = 0;
  std::int64_t first_sliver = 0, first_folded = 0;
  for (std::size_t e = 0; e < mesh.size(); ++e) {
    const std::int64_t number = mesh.element_number[e];
    const auto keep_least = [&](WorstElement& worst, double value) {
      if (value < worst.value) worst = {value, number, {}};
    };
    const CornerFigures figures = corner_figures(mesh, e);
    const double least = degrees(figures.greatest_cosine), greatest = degrees(figures.least_cosine);
    keep_least(q.least_dihedral, least);
    if (greatest > q.greatest_dihedral.value) q.greatest_dihedral = {greatest, number, {}};
    keep_least(q.least_jacobian, figures.jacobian);
    if (figures.ratio < q.least_ratio.value) q.least_ratio = {figures.ratio, number, element_middle(mesh, e)};
    keep_least(q.shortest_height, figures.height);
    const double volume = element_volume(mesh, e);
    keep_least(q.least_volume, volume);
    q.volume += volume;
    if ((least < 5 || greatest > 175) && q.slivers++ == 0) first_sliver = number;
    if (figures.jacobian <= 0 && folded++ == 0) first_folded = number;
  }
  q.least_volume.value = ratio(q.least_volume.value * static_cast<double>(mesh.size()), q.volume);
  q.sentence = sentence_of(mesh, q);
  const std::string place = mesh.file.empty() ? "" : mesh.file + ": ";
  if (q.slivers > 0)
    q.messages.push_back(place + std::to_string(q.slivers) + " of " + std::to_string(mesh.size()) +
                         " elements are slivers (a dihedral angle below 5 or above 175 degrees; the first: element " +
                         std::to_string(first_sliver) + "; the flattest: element " +
                         std::to_string(q.least_ratio.number) + " at " + place_text(q.least_ratio.middle) +
                         "); they lock and slow the solver down");
  if (folded > 0)
    q.messages.push_back(place + std::to_string(folded) + " of " + std::to_string(mesh.size()) +
                         " elements are folded at a corner (the first: element " + std::to_string(first_folded) + ")");
  return q;
}

}  // namespace fascia
