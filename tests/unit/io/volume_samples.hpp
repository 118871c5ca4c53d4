#pragma once

#include "core/base/index.hpp"
#include "io/result_writer.hpp"

#include <array>
#include <cstddef>

/// Blocks of volume cells for result files.
namespace fascia::samples {

/// n × 1 × 1 unit cubes in a row along x, as linear or quadratic hexahedra, or as six tetrahedra each (shared points
/// are shared). Every point holds "height", its z [m]; every cell "number", counted from 1.
inline io::VisualMesh row_of_cubes(int n, CellType type, bool quadratic) {
  io::VisualMesh mesh;
  std::vector<int> index(at(9 * (2 * n + 1)), -1);
  const auto point = [&](const std::array<int, 3>& half) {  // in halves of the edge
    int& p = index[at(half[0] + (2 * n + 1) * (half[1] + 3 * half[2]))];
    if (p < 0) {
      p = static_cast<int>(mesh.points.size());
      mesh.points.push_back({{0.5 * half[0], 0.5 * half[1], 0.5 * half[2]}});
    }
    return p;
  };
  using Corner = std::array<int, 3>;
  constexpr std::array<Corner, 8> cube{
      {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}}};
  constexpr std::array<std::array<int, 4>, 6> split{
      {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}}};
  using Edge = std::array<int, 2>;
  const std::vector<Edge> edges = type == CellType::tetrahedron
                                      ? std::vector<Edge>{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}
                                      : std::vector<Edge>{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                                          {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  io::VisualCells cells{type, quadratic, {}};
  const auto add = [&](const std::vector<Corner>& corners) {
    for (const Corner& c : corners) cells.nodes.push_back(point(c));
    if (!quadratic) return;
    for (const auto& [a, b] : edges) {
      Corner middle{};
      for (std::size_t c = 0; c < 3; ++c) middle[c] = (corners[at(a)][c] + corners[at(b)][c]) / 2;
      cells.nodes.push_back(point(middle));
    }
  };
  for (int i = 0; i < n; ++i) {
    std::vector<Corner> corners(cube.begin(), cube.end());
    for (Corner& c : corners) c[0] += 2 * i;
    if (type == CellType::hexahedron) add(corners);
    if (type == CellType::tetrahedron)
      for (const auto& t : split) add({corners[at(t[0])], corners[at(t[1])], corners[at(t[2])], corners[at(t[3])]});
  }
  io::FieldArray height{"height", 1, {}}, number{"number", 1, {}};
  for (const Vec3d& x : mesh.points) height.values.push_back(x[2]);
  for (std::size_t c = 0; c < cells.size(); ++c) number.values.push_back(static_cast<double>(c) + 1);
  mesh.point_fields = {height};
  mesh.cell_fields = {number};
  mesh.part.assign(cells.size(), 0);
  mesh.volumes = {cells};
  return mesh;
}

}  // namespace fascia::samples
