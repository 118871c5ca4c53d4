#include "core/geometry/surface_parts.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/geometry/weld.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fascia::surface_parts {
namespace {

constexpr double weld_tolerance = 1e-9;      // of the diagonal
constexpr double largest_coordinate = 1e60;  // volumes stay finite
constexpr double smallest_diagonal = 1e-60;  // volumes stay normal numbers
constexpr double smallest_volume = 1e-12;    // of the cube of the diagonal

/// Numbers the used points; −1 for the others.
std::vector<int> number_used(const Mesh& mesh, bool (*wanted)(CellType)) {
  std::vector<int> number(mesh.points.size(), -1);
  for (const CellBlock& block : mesh.blocks)
    if (wanted(block.type))
      for (const int node : block.nodes) number[static_cast<std::size_t>(node)] = 0;
  int next = 0;
  for (int& n : number)
    if (n == 0) n = next++;
  return number;
}

/// Diagonal of the box around the points that the cells use [m].
double diagonal_of(const std::vector<Vec3d>& points, const std::vector<Cell>& cells) {
  Bounds bounds;
  for (const Cell& cell : cells)
    for (int n = 0; n < node_count(cell.type); ++n) bounds.include(points[at(cell.nodes[at(n)])]);
  return bounds.diagonal();
}

void weld(Solid& solid, std::vector<std::string>& messages) {
  const std::vector<int> target = weld_points(solid.points, weld_tolerance * solid.diagonal);
  std::size_t welded = 0;
  for (std::size_t i = 0; i < target.size(); ++i) welded += target[i] != static_cast<int>(i) ? 1u : 0u;
  if (welded == 0) return;
  for (Cell& cell : solid.cells)
    for (int n = 0; n < node_count(cell.type); ++n) {
      int& node = cell.nodes[static_cast<std::size_t>(n)];
      node = target[static_cast<std::size_t>(node)];
    }
  messages.push_back(solid.file + ": welded " + std::to_string(welded) + " points that coincide with others");
}

}  // namespace

bool is_volume(CellType type) { return type >= CellType::tetrahedron; }
bool is_surface(CellType type) { return type == CellType::triangle || type == CellType::quadrilateral; }

void fail(const Solid& solid, const std::string& message) { throw InputError(solid.file + ": " + message); }

std::size_t count_cells(const Mesh& mesh, bool (*wanted)(CellType)) {
  std::size_t count = 0;
  for (const CellBlock& block : mesh.blocks)
    if (wanted(block.type)) count += block.size();
  return count;
}

void check_points(const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    for (int c = 0; c < 3; ++c)
      if (!(std::abs(mesh.points[i][c]) <= largest_coordinate))
        throw InputError(mesh.file + ": node " + std::to_string(mesh.point_file_number[i]) + ": coordinate " +
                         std::to_string(mesh.points[i][c]) + " is not usable; must be finite and below 1e60 m");
}

void report_unused(const Mesh& mesh, std::vector<std::string>& messages) {
  const std::vector<int> number = number_used(mesh, [](CellType) { return true; });
  const auto unused = std::count(number.begin(), number.end(), -1);
  if (unused == 0) return;
  const auto first = static_cast<std::size_t>(std::find(number.begin(), number.end(), -1) - number.begin());
  messages.push_back(mesh.file + ": left out " + std::to_string(unused) +
                     " points that no cell uses (the first: node " + std::to_string(mesh.point_file_number[first]) +
                     ")");
}

Solid make_solid(const Mesh& mesh, bool (*wanted)(CellType), std::vector<std::string>& messages) {
  Solid solid;
  solid.file = mesh.file;
  const std::vector<int> number = number_used(mesh, wanted);
  for (std::size_t i = 0; i < number.size(); ++i)
    if (number[i] >= 0) {
      solid.points.push_back(mesh.points[i]);
      solid.point_file_number.push_back(mesh.point_file_number[i]);
    }
  for (const CellBlock& block : mesh.blocks) {
    if (!wanted(block.type)) continue;
    const auto size = static_cast<std::size_t>(node_count(block.type));
    for (std::size_t c = 0; c < block.size(); ++c) {
      Cell cell{block.type, {}, block.file_number[c], block.group[c]};
      for (std::size_t n = 0; n < size; ++n)
        cell.nodes[n] = number[static_cast<std::size_t>(block.nodes[c * size + n])];
      solid.cells.push_back(cell);
    }
  }
  solid.diagonal = diagonal_of(solid.points, solid.cells);
  if (!(solid.diagonal > smallest_diagonal)) fail(solid, "all its points coincide; give a mesh that has an extent");
  weld(solid, messages);
  return solid;
}

Solid with_cells(const Solid& solid, std::vector<Cell> cells) {
  Solid part{solid.file, solid.points, solid.point_file_number, std::move(cells), 0};
  part.diagonal = diagonal_of(part.points, part.cells);
  return part;
}

TriangleMesh compact(const Solid& solid, const std::vector<Triangle>& triangles) {
  std::vector<int> number(solid.points.size(), -1);
  for (const Triangle& t : triangles)
    for (const int node : t.nodes) number[static_cast<std::size_t>(node)] = 0;
  TriangleMesh mesh;
  for (std::size_t i = 0; i < number.size(); ++i)
    if (number[i] == 0) {
      number[i] = static_cast<int>(mesh.points.size());
      mesh.points.push_back(solid.points[i]);
    }
  mesh.triangles.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    std::array<int, 3> nodes{};
    for (std::size_t n = 0; n < 3; ++n) nodes[n] = number[static_cast<std::size_t>(t.nodes[n])];
    mesh.triangles.push_back(nodes);
  }
  return mesh;
}

double enclosed_volume(const std::vector<Vec3d>& points, const std::vector<Triangle>& triangles) {
  Vec3d center{};
  for (const Triangle& t : triangles)
    for (const int node : t.nodes)
      center += points[static_cast<std::size_t>(node)] * (1.0 / (3.0 * static_cast<double>(triangles.size())));
  double volume = 0;
  for (const Triangle& t : triangles) {
    const auto corner = [&](std::size_t n) { return points[static_cast<std::size_t>(t.nodes[n])] - center; };
    volume += dot(corner(0), cross(corner(1), corner(2))) / 6;
  }
  return volume;
}

ClosedSurface enclose(const Solid& solid, const std::vector<Triangle>& triangles) {
  ClosedSurface result;
  result.volume = enclosed_volume(solid.points, triangles);
  if (!(result.volume > smallest_volume * solid.diagonal * solid.diagonal * solid.diagonal))
    fail(solid, "its surface encloses no volume; give the closed surface of a solid");
  result.mesh = compact(solid, triangles);
  return result;
}

}  // namespace fascia::surface_parts
