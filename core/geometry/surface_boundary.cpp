#include "core/geometry/surface_parts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <utility>

namespace fascia::surface_parts {
namespace {

constexpr double flat_volume = 1e-10;  // of the cube of a cell's longest distance
constexpr double flat_area = 1e-10;    // of the square of a triangle's longest edge

/// Local nodes of a face, outward for a cell of positive volume; −1 where the face is a triangle.
using LocalFace = std::array<int, 4>;

std::span<const LocalFace> faces_of(CellType type) {
  static constexpr std::array<LocalFace, 4> tetrahedron{{{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}}};
  static constexpr std::array<LocalFace, 6> hexahedron{
      {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
  static constexpr std::array<LocalFace, 5> wedge{
      {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};
  static constexpr std::array<LocalFace, 5> pyramid{
      {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}};
  switch (type) {
    case CellType::tetrahedron:
      return tetrahedron;
    case CellType::hexahedron:
      return hexahedron;
    case CellType::wedge:
      return wedge;
    case CellType::pyramid:
      return pyramid;
    default:
      return {};
  }
}

/// The distinct corners of a face, three or four; fewer where the face has collapsed.
struct Face {
  std::array<int, 4> nodes{-1, -1, -1, -1};  ///< in their order around the face
  int size = 0;
  std::array<int, 4> key{-1, -1, -1, -1};  ///< sorted
  int cell = 0;
};

Face make_face(const Cell& cell, const LocalFace& local, int cell_index) {
  Face face;
  face.cell = cell_index;
  for (const int n : local) {
    if (n < 0) continue;
    const int node = cell.nodes[static_cast<std::size_t>(n)];
    if (std::find(face.nodes.begin(), face.nodes.begin() + face.size, node) == face.nodes.begin() + face.size)
      face.nodes[static_cast<std::size_t>(face.size++)] = node;
  }
  face.key = face.nodes;
  std::sort(face.key.begin(), face.key.end());
  return face;
}

/// Splits a quadrilateral at the node of the lowest index, so that both its cells split it alike.
void append_triangles(std::span<const int> nodes, std::int64_t file_number, std::vector<Triangle>& triangles) {
  const std::size_t n = nodes.size();
  const auto s = static_cast<std::size_t>(std::min_element(nodes.begin(), nodes.end()) - nodes.begin());
  for (std::size_t k = 1; k + 1 < n; ++k)
    triangles.push_back({{nodes[s], nodes[(s + k) % n], nodes[(s + k + 1) % n]}, file_number});
}

/// Volume by the divergence theorem over the cell's split faces.
double cell_volume(const Solid& solid, const Cell& cell) {
  std::vector<Triangle> triangles;
  for (const LocalFace& local : faces_of(cell.type)) {
    const Face face = make_face(cell, local, 0);
    append_triangles(std::span(face.nodes).first(static_cast<std::size_t>(face.size)), 0, triangles);
  }
  return triangles.empty() ? 0 : enclosed_volume(solid.points, triangles);
}

double longest_distance(const Solid& solid, const Cell& cell) {
  double longest = 0;
  const auto size = static_cast<std::size_t>(node_count(cell.type));
  for (std::size_t a = 0; a < size; ++a)
    for (std::size_t b = 0; b < a; ++b)
      longest = std::max(longest, norm(solid.points[static_cast<std::size_t>(cell.nodes[a])] -
                                       solid.points[static_cast<std::size_t>(cell.nodes[b])]));
  return longest;
}

std::string number_of(const Cell& cell) { return std::to_string(cell.file_number); }

/// True where all cells are inverted.
bool check_orientation(const Solid& solid, const std::vector<Cell>& cells) {
  std::size_t inverted = 0, first_inverted = 0, first_right = 0;
  for (std::size_t c = cells.size(); c-- > 0;) {
    const double volume = cell_volume(solid, cells[c]), length = longest_distance(solid, cells[c]);
    if (!(std::abs(volume) > flat_volume * length * length * length))
      fail(solid, "cell " + number_of(cells[c]) + " is flat (its volume is below 1e-10 of its longest edge cubed); " +
                      "remove it or mesh again");
    inverted += volume < 0 ? 1u : 0u;
    (volume < 0 ? first_inverted : first_right) = c;
  }
  if (inverted == 0 || inverted == cells.size()) return inverted > 0;
  const bool few_inverted = 2 * inverted <= cells.size();
  fail(solid, "cell " + number_of(cells[few_inverted ? first_inverted : first_right]) + " is " +
                  (few_inverted ? "inverted" : "oriented against the others") + ", as are " +
                  std::to_string((few_inverted ? inverted : cells.size() - inverted) - 1) + " more of " +
                  std::to_string(cells.size()) + " cells; orient all cells alike");
}

/// Volume cells without those that a file repeats, because they belong to several groups or by mistake, which a message
/// says. Of surface cells those of one group are all kept.
std::vector<Cell> distinct_cells(const Solid& solid, std::vector<std::string>& messages) {
  struct Entry {
    std::array<int, 8> key;
    int cell;
  };
  std::vector<Entry> entries;
  entries.reserve(solid.cells.size());
  for (std::size_t c = 0; c < solid.cells.size(); ++c) {
    Entry entry{solid.cells[c].nodes, static_cast<int>(c)};
    const int size = node_count(solid.cells[c].type);
    std::fill(entry.key.begin() + size, entry.key.end(), -1);
    std::sort(entry.key.begin(), entry.key.end());
    entries.push_back(entry);
  }
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return a.key != b.key ? a.key < b.key : a.cell < b.cell; });
  std::vector<bool> keep(solid.cells.size(), true);
  std::size_t copies = 0;
  std::string first;
  for (std::size_t e = 1; e < entries.size(); ++e) {
    if (entries[e].key != entries[e - 1].key) continue;
    const Cell& a = solid.cells[static_cast<std::size_t>(entries[e - 1].cell)];
    const Cell& b = solid.cells[static_cast<std::size_t>(entries[e].cell)];
    if (a.group == b.group && !is_volume(b.type)) continue;
    if (a.group == b.group) {
      // Four nodes make one tetrahedron only; of other cells their order may make another shape.
      if (b.type != CellType::tetrahedron && a.nodes != b.nodes)
        fail(solid, "cells " + number_of(a) + " and " + number_of(b) + " have the same nodes; remove one of them");
      if (copies++ == 0) first = number_of(b) + ", which repeats cell " + number_of(a);
    }
    keep[static_cast<std::size_t>(entries[e].cell)] = false;
  }
  std::vector<Cell> cells;
  for (std::size_t c = 0; c < keep.size(); ++c)
    if (keep[c]) cells.push_back(solid.cells[c]);
  if (copies > 0)
    messages.push_back(
        solid.file + ": left out " + std::to_string(copies) +
        (copies == 1 ? " cell that repeats another (cell " : " cells that repeat others (the first: cell ") + first +
        ")");
  return cells;
}

std::vector<Face> sorted_faces(const std::vector<Cell>& cells) {
  std::vector<Face> faces;
  faces.reserve(4 * cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const LocalFace& local : faces_of(cells[c].type)) {
      const Face face = make_face(cells[c], local, static_cast<int>(c));
      if (face.size >= 3) faces.push_back(face);
    }
  std::sort(faces.begin(), faces.end(),
            [](const Face& a, const Face& b) { return a.key != b.key ? a.key < b.key : a.cell < b.cell; });
  return faces;
}

/// The same corners in opposite order around the face: cells on either side of it.
bool opposite(const Face& a, const Face& b) {
  const auto n = static_cast<std::size_t>(a.size);
  const auto start = static_cast<std::size_t>(std::find(b.nodes.begin(), b.nodes.end(), a.nodes[0]) - b.nodes.begin());
  return b.nodes[(start + n - 1) % n] == a.nodes[1];
}

double relative_area(const Solid& solid, const Triangle& t) {
  const auto corner = [&](std::size_t n) { return solid.points[static_cast<std::size_t>(t.nodes[n])]; };
  const Vec3d a = corner(1) - corner(0), b = corner(2) - corner(0), c = corner(2) - corner(1);
  const double longest = std::max({squared_norm(a), squared_norm(b), squared_norm(c)});
  return longest > 0 ? norm(cross(a, b)) / (2 * longest) : 0;
}

using TriangleKey = std::array<int, 3>;

TriangleKey key_of(int a, int b, int c) {
  TriangleKey key{a, b, c};
  std::sort(key.begin(), key.end());
  return key;
}

/// Three corners of a face, for all faces of the volume cells; of a quadrilateral every three. Sorted.
std::vector<TriangleKey> face_triangles(const Solid& solid) {
  std::vector<TriangleKey> keys;
  for (const Cell& cell : solid.cells)
    for (const LocalFace& local : faces_of(cell.type)) {
      const Face face = make_face(cell, local, 0);
      const std::array<int, 4>& n = face.nodes;
      if (face.size >= 3) keys.push_back(key_of(n[0], n[1], n[2]));
      if (face.size == 4)
        for (const auto& key : {key_of(n[1], n[2], n[3]), key_of(n[2], n[3], n[0]), key_of(n[3], n[0], n[1])})
          keys.push_back(key);
    }
  std::sort(keys.begin(), keys.end());
  return keys;
}

}  // namespace

std::vector<Cell> cells_off_volumes(const Solid& solid) {
  const std::vector<TriangleKey> faces = face_triangles(solid);
  const auto is_face = [&](const Cell& cell, std::size_t a, std::size_t b, std::size_t c) {
    return std::binary_search(faces.begin(), faces.end(), key_of(cell.nodes[a], cell.nodes[b], cell.nodes[c]));
  };
  std::vector<Cell> cells;
  for (const Cell& cell : solid.cells) {
    const bool off = (cell.type == CellType::triangle && !is_face(cell, 0, 1, 2)) ||
                     (cell.type == CellType::quadrilateral && !(is_face(cell, 0, 1, 2) && is_face(cell, 0, 2, 3)) &&
                      !(is_face(cell, 0, 1, 3) && is_face(cell, 1, 2, 3)));
    if (off) cells.push_back(cell);
  }
  return cells;
}

std::vector<Triangle> boundary_of_cells(const Solid& solid, std::vector<std::string>& messages) {
  const std::vector<Cell> cells = distinct_cells(solid, messages);
  const bool inverted = check_orientation(solid, cells);
  if (inverted)
    messages.push_back(solid.file + ": all " + std::to_string(cells.size()) + " cells are inverted; turned over");

  const std::vector<Face> faces = sorted_faces(cells);
  std::vector<Triangle> triangles;
  for (std::size_t f = 0, end = 0; f < faces.size(); f = end) {
    for (end = f; end < faces.size() && faces[end].key == faces[f].key;) ++end;
    const auto cell = [&](std::size_t face) { return cells[static_cast<std::size_t>(faces[face].cell)]; };
    if (end - f > 2 || (end - f == 2 && !opposite(faces[f], faces[f + 1])))
      fail(solid, "cells " + number_of(cell(f)) + " and " + number_of(cell(f + 1)) +
                      " overlap: they lie on the same side of a common face; mesh again");
    if (end - f == 1)
      append_triangles(std::span(faces[f].nodes).first(static_cast<std::size_t>(faces[f].size)), cell(f).file_number,
                       triangles);
  }
  if (inverted)
    for (Triangle& t : triangles) std::swap(t.nodes[1], t.nodes[2]);
  return triangles;
}

std::vector<Triangle> triangles_of_cells(const Solid& solid, std::vector<std::string>& messages) {
  std::vector<Triangle> triangles;
  for (const Cell& cell : distinct_cells(solid, messages))
    append_triangles(std::span(cell.nodes).first(static_cast<std::size_t>(node_count(cell.type))), cell.file_number,
                     triangles);
  for (const Triangle& t : triangles)
    if (!(relative_area(solid, t) > flat_area))
      fail(solid, "triangle " + std::to_string(t.file_number) + " is flat (its area is below 1e-10 of its longest " +
                      "edge squared); remove it or mesh again");
  return without_repeats(solid, std::move(triangles), messages);
}

}  // namespace fascia::surface_parts
