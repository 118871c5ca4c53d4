#pragma once

#include "core/geometry/primitives.hpp"
#include "core/math/rotation.hpp"
#include "coupling/gap.hpp"
#include "shells/generate.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <random>

/// Sides of gaps for tests.
namespace fascia::test {

/// An open side: all of a surface.
inline GapSide open_side(const std::string& body, const TriangleMesh& mesh) { return {body, mesh, mesh, false}; }

/// A flat rectangle at a height, from (x, y) on.
inline GapSide plate(const std::string& body, const Vec3d& origin, double length, double width,
                     const std::array<int, 2>& cells, Diagonal diagonal = Diagonal::alternating) {
  const ShellMesh mesh = rectangle(origin, {{length, 0, 0}}, {{0, width, 0}}, cells, diagonal);
  return open_side(body, {mesh.nodes, mesh.triangles});
}

/// A closed side: the triangles of a solid all of whose corners are selected.
inline GapSide closed_side(const std::string& body, const TriangleMesh& solid,
                           const std::function<bool(const Vec3d&)>& where) {
  GapSide side{body, {solid.points, {}}, solid, true};
  for (const auto& t : solid.triangles)
    if (std::all_of(t.begin(), t.end(), [&](int i) { return where(solid.points[static_cast<std::size_t>(i)]); }))
      side.faces.triangles.push_back(t);
  return side;
}

inline void for_each_point(GapSide& side, const std::function<Vec3d(const Vec3d&)>& map) {
  for (TriangleMesh* mesh : {&side.faces, &side.whole})
    for (Vec3d& X : mesh->points) X = map(X);
}

/// The same side with its vertices, triangles and the triangles' first corners in another order; an open one with its
/// triangles turned over at random too.
inline GapSide shuffled(const GapSide& side, unsigned seed) {
  std::mt19937 random(seed);
  GapSide other = side;
  for (TriangleMesh* mesh : {&other.faces, &other.whole}) {
    std::vector<std::size_t> place(mesh->points.size());
    for (std::size_t i = 0; i < place.size(); ++i) place[i] = i;
    std::shuffle(place.begin(), place.end(), random);
    const TriangleMesh old = *mesh;
    for (std::size_t i = 0; i < place.size(); ++i) mesh->points[place[i]] = old.points[i];
    for (auto& t : mesh->triangles) {
      for (int& node : t) node = static_cast<int>(place[static_cast<std::size_t>(node)]);
      std::rotate(t.begin(), t.begin() + random() % 3, t.end());
      if (!side.closed && random() % 2 == 0) std::swap(t[0], t[1]);
    }
    std::shuffle(mesh->triangles.begin(), mesh->triangles.end(), random);
  }
  return other;
}

/// Each edge of a closed surface is run through once in each direction.
inline bool is_closed(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> count;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++count[{t[k], t[(k + 1) % 3]}];
  return std::all_of(count.begin(), count.end(), [&](const auto& edge) {
    const auto back = count.find({edge.first.second, edge.first.first});
    return edge.second == 1 && back != count.end() && back->second == 1;
  });
}

/// Least height of a triangle [m].
inline double least_height(const TriangleMesh& mesh) {
  double least = 1e300;
  for (const auto& t : mesh.triangles) {
    const Vec3d &a = mesh.points[static_cast<std::size_t>(t[0])], &b = mesh.points[static_cast<std::size_t>(t[1])],
                &c = mesh.points[static_cast<std::size_t>(t[2])];
    least = std::min(least, norm(cross(b - a, c - a)) / std::max({norm(b - a), norm(c - a), norm(c - b)}));
  }
  return least;
}

}  // namespace fascia::test
