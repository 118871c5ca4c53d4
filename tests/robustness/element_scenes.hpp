#pragma once

#include "tests/robustness/scene_runs.hpp"

#include <array>
#include <cstddef>
#include <cstdio>

/// A cantilever of finite elements: as a scene, and as mesh files that can be spoiled.
namespace fascia::test {

/// Clamped at x = 0, bends under its own weight by a tenth of its length at most; solved in milliseconds.
inline constexpr const char* kElements = R"(title = "Small cantilever"

[world]
gravity = [0, -1, 0]

[materials.soft]
young   = "100 kPa"
poisson = 0.3

[bodies.beam]
model    = "tetrahedra"
domain   = { box = { min = [0, 0, 0], max = [1, 0.2, 0.2], cells = [5, 1, 1] } }
density  = 1000
material = "soft"

[[constraints]]
body  = "beam"
where = { box = { min = [-0.01, -1, -1], max = [0.01, 1, 1] } }
fix   = "all"

[solver]
kind = "static"

[probes.tip]
body = "beam"
at = [1, 0.1, 0.1]
quantity = "displacement"

[probes.weight]
body = "beam"
quantity = "mass"
)";

inline constexpr const char* kElementBox = "{ box = { min = [0, 0, 0], max = [1, 0.2, 0.2], cells = [5, 1, 1] } }";
inline constexpr const char* kClamp = "{ box = { min = [-0.01, -1, -1], max = [0.01, 1, 1] } }";
inline constexpr const char* kAllFixed = "fix   = \"all\"";

/// The same scene with a mesh file in the place of the box.
inline std::string scene_of_file(const std::string& file, const std::string& model = "tetrahedra") {
  return with(with(kElements, kElementBox, "{ file = \"" + file + "\" }"), "\"tetrahedra\"", "\"" + model + "\"");
}

/// A cell with its Gmsh type and physical group, nodes counted from 0.
struct FileCell {
  int type = 0, group = 0;
  std::vector<int> nodes;
};

/// A mesh as a Gmsh file lists it; nodes and cells are numbered from 1 there.
struct FileMesh {
  static constexpr int triangle = 2, quadrilateral = 3, tetrahedron = 4, hexahedron = 5, wedge = 6,
                       quadratic_tetrahedron = 11;
  std::vector<std::array<double, 3>> nodes;
  std::vector<FileCell> cells;
  std::string names;  ///< lines "dimension number "name""

  /// Gmsh 2.2 as text.
  std::string text() const {
    std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
    const auto count = std::count(names.begin(), names.end(), '\n');
    if (count > 0) text += "$PhysicalNames\n" + std::to_string(count) + "\n" + names + "$EndPhysicalNames\n";
    text += "$Nodes\n" + std::to_string(nodes.size()) + "\n";
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      std::array<char, 120> line{};
      std::snprintf(line.data(), line.size(), "%zu %.17g %.17g %.17g\n", i + 1, nodes[i][0], nodes[i][1], nodes[i][2]);
      text += line.data();
    }
    text += "$EndNodes\n$Elements\n" + std::to_string(cells.size()) + "\n";
    for (std::size_t c = 0; c < cells.size(); ++c) {
      text +=
          std::to_string(c + 1) + " " + std::to_string(cells[c].type) + " 2 " + std::to_string(cells[c].group) + " 1";
      for (const int node : cells[c].nodes) text += " " + std::to_string(node + 1);
      text += "\n";
    }
    return text + "$EndElements\n";
  }

  void swap_nodes(std::size_t cell, std::size_t a, std::size_t b) {
    std::swap(cells[cell].nodes[a], cells[cell].nodes[b]);
  }
};

/// The beam as `n` hexahedra in a row; the first is of group 1, the others of group 2. Node i + (n + 1)(j + 2k).
inline FileMesh hexahedra_beam(int n = 2) {
  FileMesh mesh;
  for (const double z : {0.0, 0.2})
    for (const double y : {0.0, 0.2})
      for (int i = 0; i <= n; ++i) mesh.nodes.push_back({1.0 * i / n, y, z});
  const int y = n + 1, z = 2 * y;
  for (int i = 0; i < n; ++i)
    mesh.cells.push_back({FileMesh::hexahedron,
                          i == 0 ? 1 : 2,
                          {i, i + 1, i + 1 + y, i + y, i + z, i + 1 + z, i + 1 + y + z, i + y + z}});
  mesh.names = "3 1 \"organ\"\n3 2 \"stiff\"\n";
  return mesh;
}

/// The same as six tetrahedra for each hexahedron, with the clamped end as group 5, "hilum".
inline FileMesh tetrahedra_beam() {
  constexpr std::array<std::array<std::size_t, 4>, 6> split{
      {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}}};
  const FileMesh hexahedra = hexahedra_beam();
  FileMesh mesh = hexahedra;
  mesh.cells.clear();
  for (const FileCell& cell : hexahedra.cells)
    for (const auto& corners : split) {
      FileCell tetrahedron{FileMesh::tetrahedron, cell.group, {}};
      for (const std::size_t k : corners) tetrahedron.nodes.push_back(cell.nodes[k]);
      mesh.cells.push_back(tetrahedron);
    }
  mesh.cells.push_back({FileMesh::triangle, 5, {0, 3, 9}});
  mesh.cells.push_back({FileMesh::triangle, 5, {0, 9, 6}});
  mesh.names += "2 5 \"hilum\"\n";
  return mesh;
}

/// The tetrahedra with a node in the middle of each edge.
inline FileMesh quadratic_beam() {
  constexpr std::array<std::array<std::size_t, 2>, 6> edges{{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}}};
  FileMesh mesh = tetrahedra_beam();
  std::map<std::pair<int, int>, int> middle;
  for (FileCell& cell : mesh.cells) {
    if (cell.type != FileMesh::tetrahedron) continue;
    cell.type = FileMesh::quadratic_tetrahedron;
    for (const auto& [a, b] : edges) {
      const auto [low, high] = std::minmax(cell.nodes[a], cell.nodes[b]);
      const auto [found, is_new] = middle.try_emplace({low, high}, static_cast<int>(mesh.nodes.size()));
      if (is_new) {
        const auto &A = mesh.nodes[static_cast<std::size_t>(low)], &B = mesh.nodes[static_cast<std::size_t>(high)];
        mesh.nodes.push_back({(A[0] + B[0]) / 2, (A[1] + B[1]) / 2, (A[2] + B[2]) / 2});
      }
      cell.nodes.push_back(found->second);
    }
  }
  return mesh;
}

}  // namespace fascia::test
