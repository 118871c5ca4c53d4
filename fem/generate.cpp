#include "fem/generate.hpp"

#include "fem/generate_parts.hpp"
#include "fem/quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fascia {

using namespace generate_parts;

namespace {

using Tetrahedron = std::array<int, 4>;

constexpr std::array<Tetrahedron, 6> six{
    {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}}};
constexpr std::array<Tetrahedron, 5> five_even{{{0, 1, 2, 5}, {0, 2, 3, 7}, {0, 5, 7, 4}, {2, 7, 5, 6}, {0, 2, 7, 5}}};
constexpr std::array<Tetrahedron, 5> five_odd{{{1, 2, 3, 6}, {0, 1, 3, 4}, {1, 6, 4, 5}, {3, 4, 6, 7}, {1, 3, 4, 6}}};

/// The corner that takes the place of a corner in a mirrored hexahedron.
int mirrored(int corner, const std::array<bool, 3>& along) {
  constexpr std::array<int, 8> bits{0, 1, 3, 2, 4, 5, 7, 6};  // of x, y, z; the table is its own inverse
  const int flip = (along[0] ? 1 : 0) + (along[1] ? 2 : 0) + (along[2] ? 4 : 0);
  return bits[at(bits[at(corner)] ^ flip)];
}

/// Cells of a structured grid whose nodes run x fastest, then y, then z.
template <class Place>
HexahedronGrid structured_grid(const std::array<int, 3>& cells, Place&& place) {
  HexahedronGrid grid;
  for (int k = 0; k <= cells[2]; ++k)
    for (int j = 0; j <= cells[1]; ++j)
      for (int i = 0; i <= cells[0]; ++i) grid.nodes.push_back(place(std::array<int, 3>{i, j, k}));
  const auto node = [&](int i, int j, int k) { return i + (cells[0] + 1) * (j + (cells[1] + 1) * k); };
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i) {
        std::array<int, 8> cell{};
        for (std::size_t c = 0; c < 4; ++c) {
          const int di = c == 1 || c == 2 ? 1 : 0, dj = c >= 2 ? 1 : 0;
          cell[c] = node(i + di, j + dj, k);
          cell[c + 4] = node(i + di, j + dj, k + 1);
        }
        grid.cells.push_back(cell);
        grid.parity.push_back({i % 2 != 0, j % 2 != 0, k % 2 != 0});
      }
  return grid;
}

void check_grid(const std::array<int, 3>& cells, const ElementKind& kind) {
  check_kind(kind);
  for (std::size_t c = 0; c < 3; ++c) check_cells(std::string("cells along ") + "xyz"[c], cells[c]);
  check_total(double(cells[0]) * cells[1] * cells[2]);
}

void check_corners(const std::array<Vec3d, 8>& corners) {
  const std::string remedy =
      "; give them in the order of a hexahedron's nodes: around the bottom, then around the top above it";
  ElementMesh block;
  block.shape = ElementShape::hex8;
  block.nodes.assign(corners.begin(), corners.end());
  block.element_nodes = {0, 1, 2, 3, 4, 5, 6, 7};
  double longest = 0;
  for (const auto& [a, b] : edges_of(ElementFamily::hexahedra))
    longest = std::max(longest, norm(corners[at(a)] - corners[at(b)]));
  if (!std::isfinite(longest) || !(longest > 0)) throw InputError("the block's corners coincide" + remedy);
  for (const Vec3d& xi : reference_corners(ElementFamily::hexahedra))
    if (!(shape_at(block, 0, xi).det_J > 1e-9 * longest * longest * longest))
      throw InputError("the block's corners make it flat, folded or turned the wrong way round" + remedy);
}

}  // namespace

void generate_parts::check_kind(const ElementKind& kind) {
  if (kind.order != 1 && kind.order != 2)
    throw InputError("elements of order " + std::to_string(kind.order) + "; must be 1 or 2");
  if (kind.family == ElementFamily::tetrahedra && kind.split != 5 && kind.split != 6)
    throw InputError("a hexahedron split into " + std::to_string(kind.split) + " tetrahedra; must be 5 or 6");
}

void generate_parts::check_cells(const std::string& what, int count) {
  if (count < 1) throw InputError(what + ": " + std::to_string(count) + " is out of range; must be at least 1");
}

void generate_parts::check_total(double total) {
  if (total > 2e7) throw InputError("more than 20 million cells; give fewer");
}

ElementMesh generate_parts::elements_of(const HexahedronGrid& grid, const ElementKind& kind) {
  ElementMesh mesh;
  mesh.shape = element_shape(kind.family, 1);
  mesh.nodes = grid.nodes;
  if (kind.family == ElementFamily::tetrahedra && kind.split == 5 && grid.parity.empty())
    throw InputError("cells around a core cannot be split into 5 tetrahedra that match; use 6");
  for (std::size_t c = 0; c < grid.cells.size(); ++c) {
    const std::array<int, 8>& cell = grid.cells[c];
    if (kind.family == ElementFamily::hexahedra) {
      mesh.element_nodes.insert(mesh.element_nodes.end(), cell.begin(), cell.end());
      continue;
    }
    const std::array<bool, 3> parity = grid.parity.empty() ? std::array<bool, 3>{} : grid.parity[c];
    const bool odd = parity[0] != (parity[1] != parity[2]);
    if (kind.split == 5) {
      for (const Tetrahedron& part : odd ? five_odd : five_even)
        for (const int n : part) mesh.element_nodes.push_back(cell[at(n)]);
      continue;
    }
    for (const Tetrahedron& part : six) {
      Tetrahedron nodes;
      for (std::size_t n = 0; n < 4; ++n) nodes[n] = cell[at(mirrored(part[n], parity))];
      if (odd) std::swap(nodes[2], nodes[3]);
      mesh.element_nodes.insert(mesh.element_nodes.end(), nodes.begin(), nodes.end());
    }
  }
  mesh.node_number.resize(mesh.nodes.size());
  std::iota(mesh.node_number.begin(), mesh.node_number.end(), 1);
  mesh.element_number.resize(mesh.size());
  std::iota(mesh.element_number.begin(), mesh.element_number.end(), 1);
  return mesh;
}

ElementMesh generate_box(const Vec3d& min, const Vec3d& max, const std::array<int, 3>& cells, const ElementKind& kind) {
  check_grid(cells, kind);
  for (int c = 0; c < 3; ++c)
    if (!std::isfinite(max[c] - min[c]) || !(max[c] - min[c] > 1e-12 * std::max(std::abs(min[c]), std::abs(max[c]))))
      throw InputError(std::string("the box has no extent along ") + "xyz"[c] + "; min must be below max");
  const HexahedronGrid grid = structured_grid(cells, [&](const std::array<int, 3>& index) {
    Vec3d X;
    for (int c = 0; c < 3; ++c) {
      const int i = index[at(c)], n = cells[at(c)];
      X[c] = i == n ? max[c] : min[c] + (max[c] - min[c]) * i / n;
    }
    return X;
  });
  const ElementMesh linear = elements_of(grid, kind);
  return kind.order == 1 ? linear : quadratic(linear);
}

ElementMesh generate_block(const std::array<Vec3d, 8>& corners, const std::array<int, 3>& cells,
                           const ElementKind& kind) {
  check_grid(cells, kind);
  check_corners(corners);
  const HexahedronGrid grid = structured_grid(cells, [&](const std::array<int, 3>& index) {
    Vec3d xi, X;
    for (int c = 0; c < 3; ++c) xi[c] = 2.0 * index[at(c)] / cells[at(c)] - 1;
    const ShapeValues N = shape_values(ElementShape::hex8, xi);
    for (std::size_t n = 0; n < 8; ++n) X += N[n] * corners[n];
    return X;
  });
  const ElementMesh linear = elements_of(grid, kind);
  return kind.order == 1 ? linear : quadratic(linear);
}

}  // namespace fascia
