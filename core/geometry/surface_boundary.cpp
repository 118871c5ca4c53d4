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
void append_triangles(std::span<const int> nodes, std::vector<Triangle>& triangles) {
  const std::size_t n = nodes.size();
  const auto s = static_cast<std::size_t>(std::min_element(nodes.begin(), nodes.end()) - nodes.begin());
  for (std::size_t k = 1; k + 1 < n; ++k) triangles.push_back({{nodes[s], nodes[(s + k) % n], nodes[(s + k + 1) % n]}});
}

/// Volume by the divergence theorem over the cell's split faces.
double cell_volume(const Solid& solid, const Cell& cell) {
  std::vector<Triangle> triangles;
  for (const LocalFace& local : faces_of(cell.type)) {
    const Face face = make_face(cell, local, 0);
    append_triangles(std::span(face.nodes).first(static_cast<std::size_t>(face.size)), triangles);
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

using CellKey = std::array<int, 8>;

CellKey sorted_nodes(const Cell& cell) {
  CellKey key = cell.nodes;
  std::fill(key.begin() + node_count(cell.type), key.end(), -1);
  std::sort(key.begin(), key.end());
  return key;
}

/// The nodes of a surface cell from the lowest on, in their order around it.
CellKey nodes_around(const Cell& cell) {
  CellKey key = cell.nodes;
  const auto end = key.begin() + node_count(cell.type);
  std::fill(end, key.end(), -1);
  std::rotate(key.begin(), std::min_element(key.begin(), end), end);
  return key;
}

/// For each cell the first of the same key.
template <class Key>
std::vector<int> first_of_key(const std::vector<Cell>& cells, const Key& key_of_cell) {
  std::vector<std::pair<CellKey, int>> entries;
  entries.reserve(cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) entries.emplace_back(key_of_cell(cells[c]), static_cast<int>(c));
  std::sort(entries.begin(), entries.end());
  std::vector<int> first(cells.size());
  for (std::size_t e = 0; e < entries.size(); ++e) {
    const bool again = e > 0 && entries[e].first == entries[e - 1].first;
    const auto cell = static_cast<std::size_t>(entries[e].second);
    first[cell] = again ? first[static_cast<std::size_t>(entries[e - 1].second)] : entries[e].second;
  }
  return first;
}

/// Indices of the volume cells without those that a file repeats, because they belong to several groups or by mistake,
/// which a message says.
std::vector<int> distinct_volumes(const Solid& solid, std::vector<std::string>& messages) {
  const std::vector<Cell>& cells = solid.cells;
  const std::vector<int> first = first_copies(cells);
  std::vector<std::array<int, 3>> copies;  // the first, the group, the cell
  std::vector<int> kept;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    copies.push_back({first[c], cells[c].group, static_cast<int>(c)});
    if (first[c] == static_cast<int>(c)) kept.push_back(first[c]);
  }
  std::sort(copies.begin(), copies.end());
  std::size_t count = 0;
  std::string which;
  for (std::size_t k = 1; k < copies.size(); ++k) {
    if (copies[k][0] != copies[k - 1][0] || copies[k][1] != copies[k - 1][1]) continue;
    const Cell& a = cells[static_cast<std::size_t>(copies[k - 1][2])];
    const Cell& b = cells[static_cast<std::size_t>(copies[k][2])];
    // Four nodes make one tetrahedron only; of other cells their order may make another shape.
    if (b.type != CellType::tetrahedron && a.nodes != b.nodes)
      fail(solid, "cells " + number_of(a) + " and " + number_of(b) + " have the same nodes; remove one of them");
    if (count++ == 0) which = number_of(b) + ", which repeats cell " + number_of(a);
  }
  if (count > 0)
    messages.push_back(
        solid.file + ": left out " + std::to_string(count) +
        (count == 1 ? " cell that repeats another (cell " : " cells that repeat others (the first: cell ") + which +
        ")");
  return kept;
}

/// Indices of the surface cells without those that repeat others because they belong to several groups. Those that one
/// group repeats stay, and of a solid those that face the other way: without_repeats() judges them.
std::vector<int> distinct_surfaces(const Solid& solid, Surface surface) {
  const std::vector<int> first =
      surface == Surface::of_solid ? first_of_key(solid.cells, nodes_around) : first_copies(solid.cells);
  std::vector<int> kept;
  for (std::size_t c = 0; c < first.size(); ++c)
    if (solid.cells[c].group == solid.cells[static_cast<std::size_t>(first[c])].group)
      kept.push_back(static_cast<int>(c));
  return kept;
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

/// True where the triangles abc and acd, the halves of a quadrilateral, face the same way.
bool agree(const Solid& solid, int a, int b, int c, int d) {
  const auto point = [&](int node) { return solid.points[static_cast<std::size_t>(node)]; };
  const Vec3d diagonal = point(c) - point(a);
  return dot(cross(point(b) - point(a), diagonal), cross(diagonal, point(d) - point(a))) > 0;
}

/// The triangles of a surface cell. A quadrilateral is split at its lowest node, unless only the other diagonal lies
/// inside; one that faces the other way is split alike.
void append_surface(const Solid& solid, const Cell& cell, std::vector<Triangle>& triangles) {
  const CellKey n = nodes_around(cell);
  if (cell.type == CellType::quadrilateral) {
    const int b = std::min(n[1], n[3]), d = std::max(n[1], n[3]);
    if (!agree(solid, n[0], b, n[2], d) && agree(solid, b, n[2], d, n[0])) {
      triangles.push_back({{n[1], n[2], n[3]}});
      triangles.push_back({{n[1], n[3], n[0]}});
      return;
    }
  }
  append_triangles(std::span(n).first(static_cast<std::size_t>(node_count(cell.type))), triangles);
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

std::vector<int> first_copies(const std::vector<Cell>& cells) { return first_of_key(cells, sorted_nodes); }

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
  const std::vector<int> kept = distinct_volumes(solid, messages);
  std::vector<Cell> cells;
  cells.reserve(kept.size());
  for (const int c : kept) cells.push_back(solid.cells[static_cast<std::size_t>(c)]);
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
    if (end - f > 1) continue;
    const std::size_t former = triangles.size();
    append_triangles(std::span(faces[f].nodes).first(static_cast<std::size_t>(faces[f].size)), triangles);
    for (std::size_t t = former; t < triangles.size(); ++t) {
      triangles[t].file_number = cell(f).file_number;
      triangles[t].cell = kept[static_cast<std::size_t>(faces[f].cell)];
    }
  }
  if (inverted)
    for (Triangle& t : triangles) std::swap(t.nodes[1], t.nodes[2]);
  return triangles;
}

std::vector<Triangle> triangles_of_cells(const Solid& solid, Surface surface, std::vector<std::string>& messages) {
  std::vector<Triangle> triangles;
  for (const int c : distinct_surfaces(solid, surface)) {
    const Cell& cell = solid.cells[static_cast<std::size_t>(c)];
    const std::size_t former = triangles.size();
    append_surface(solid, cell, triangles);
    for (std::size_t t = former; t < triangles.size(); ++t) {
      triangles[t].file_number = cell.file_number;
      triangles[t].cell = c;
    }
  }
  for (const Triangle& t : triangles)
    if (!(relative_area(solid, t) > flat_area))
      fail(solid, "triangle " + std::to_string(t.file_number) + " is flat (its area is below 1e-10 of its longest " +
                      "edge squared); remove it or mesh again");
  return without_repeats(solid, surface, std::move(triangles), messages);
}

}  // namespace fascia::surface_parts
