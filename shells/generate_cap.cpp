#include "shells/generate_cap.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fascia::shell_parts {
namespace {

/// Rotational symmetry that the rings share with the rim.
int symmetry(int around) {
  for (const int fold : {4, 3, 2})
    if (around % fold == 0) return fold;
  return 1;
}

/// Triangles between two rings that start at angle 0, each with its nodes evenly around; the inner may be one node.
void join(const std::vector<int>& inner, const std::vector<int>& outer, ShellMesh& mesh) {
  const std::size_t n_outer = outer.size(), n_inner = inner.size() > 1 ? inner.size() : 0;
  for (std::size_t i = 0, o = 0; i < n_inner || o < n_outer;) {
    // The ring goes on whose next edge has its middle first: (o + 1/2) / n_outer ≤ (i + 1/2) / n_inner.
    const bool outward = i == n_inner || (o < n_outer && (2 * o + 1) * n_inner <= (2 * i + 1) * n_outer);
    const int a = inner[i % inner.size()], b = outer[o % n_outer];
    mesh.triangles.push_back({a, b, outward ? outer[++o % n_outer] : inner[++i % n_inner]});
  }
}

}  // namespace

void add_cap(ShellMesh& mesh, const std::vector<int>& rim) {
  const int around = static_cast<int>(rim.size()), fold = symmetry(around);
  const auto angle = [](int a, int count) { return 2 * std::numbers::pi * a / count; };
  Vec3d center{}, cosine{}, sine{};  // the rim is center + cosine cos + sine sin
  for (const int node : rim) center += mesh.nodes[at(node)] * (1.0 / around);
  for (int a = 0; a < around; ++a) {
    const Vec3d d = mesh.nodes[at(rim[at(a)])] - center;
    cosine += d * (2 * std::cos(angle(a, around)) / around);
    sine += d * (2 * std::sin(angle(a, around)) / around);
  }
  std::vector<int> inner{static_cast<int>(mesh.nodes.size())};
  mesh.nodes.push_back(center);
  const int rings = std::max(1, static_cast<int>(std::lround(around / (2 * std::numbers::pi))));
  for (int r = 1; r < rings; ++r) {
    const double radius = 1.0 * r / rings;
    const int count = std::max(3, fold * static_cast<int>(std::lround(around * radius / fold)));
    std::vector<int> ring;
    for (int a = 0; a < count; ++a) {
      ring.push_back(static_cast<int>(mesh.nodes.size()));
      mesh.nodes.push_back(center + (cosine * std::cos(angle(a, count)) + sine * std::sin(angle(a, count))) * radius);
    }
    join(inner, ring, mesh);
    inner = ring;
  }
  join(inner, rim, mesh);
}

}  // namespace fascia::shell_parts
