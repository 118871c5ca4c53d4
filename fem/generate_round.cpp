#include "fem/generate_parts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace fascia {
namespace {

using namespace generate_parts;

void check_around(int around) {
  if (around < 4 || around % 4 != 0)
    throw InputError("cells around: " + std::to_string(around) +
                     " is out of range; must be a multiple of 4, as 8 or 12");
}

/// A core of side × side (× side) cells within the unit circle or ball, and layers of cells between its faces and the
/// surface. A node is named by its place in the core, 0 to `side` along each direction, and by its layer: 0 in the
/// core.
class OGrid {
 public:
  using Name = std::array<int, 4>;

  OGrid(int dimension, int side, int layers)
      : dimension_(dimension),
        side_(side),
        layers_(layers),
        core_(std::clamp(1 / (1.1 + 2.4 * layers / side), 0.25, 0.75)) {}

  /// Place in the unit circle or ball: the core bulges halfway to a ball, layers are straight lines to the surface.
  Vec3d place(const Name& name) const {
    Vec3d u, direction;
    for (int c = 0; c < dimension_; ++c) {
      u[c] = static_cast<double>(2 * name[at(c)] - side_) / side_;
      direction[c] = std::tan(u[c] * std::numbers::pi / 4);
    }
    constexpr double bulge = 0.5;
    Vec3d core;
    for (int c = 0; c < dimension_; ++c) {
      const double v2 = bulge * u[(c + 1) % 3] * u[(c + 1) % 3], w2 = bulge * u[(c + 2) % 3] * u[(c + 2) % 3];
      core[c] = core_ * u[c] * std::sqrt(1 - v2 / 2 - w2 / 2 + v2 * w2 / 3);
    }
    if (name[3] == 0) return core;
    const Vec3d surface = normalized(direction);
    if (name[3] == layers_) return surface;
    return core + (surface - core) * (static_cast<double>(name[3]) / layers_);
  }

  bool on_surface(const Name& name) const { return name[3] == layers_; }

  /// Calls act(corners) for each cell, corners as hexahedron nodes 0 to 3 (a circle) or 0 to 7 (a ball). Node 0 lies at
  /// the least place along the core's directions and innermost, node 6 (or 2) opposite.
  template <class Act>
  void for_each_cell(Act&& act) const {
    std::array<int, 3> end{1, 1, 1};
    for (int c = 0; c < dimension_; ++c) end[at(c)] = side_;
    for (int k = 0; k < end[2]; ++k)
      for (int j = 0; j < end[1]; ++j)
        for (int i = 0; i < end[0]; ++i) act(corners({i, j, k, 0}, {0, 1, 2}, false));
    for (int axis = 0; axis < dimension_; ++axis)
      for (const bool upper : {false, true})
        for (int layer = 0; layer < layers_; ++layer) layer_cells(axis, upper, layer, act);
  }

 private:
  /// Cells between a layer and the next one, at one side of the core.
  template <class Act>
  void layer_cells(int axis, bool upper, int layer, Act&& act) const {
    const int u = (axis + 1) % dimension_, v = (axis + 2) % dimension_;
    for (int b = 0; b < (dimension_ == 3 ? side_ : 1); ++b)
      for (int a = 0; a < side_; ++a) {
        Name name{0, 0, 0, layer};
        name[at(axis)] = upper ? side_ : 0;
        name[at(u)] = a;
        if (dimension_ == 3) name[at(v)] = b;
        // Outward comes first; at the lower side and, in the plane, by the order of the axes, that turns the cell over.
        const bool mirrored = dimension_ == 3 ? !upper : upper == (axis == 1);
        act(corners(name, {3, u, dimension_ == 3 ? v : 2}, mirrored));
      }
  }

  /// The cell from `name` one step along each of three directions; mirrored ones exchange the first two.
  std::array<Name, 8> corners(const Name& name, std::array<int, 3> directions, bool mirrored) const {
    if (mirrored) std::swap(directions[0], directions[1]);
    std::array<Name, 8> result{};
    for (std::size_t n = 0; n < 8; ++n) {
      result[n] = name;
      if (n % 4 == 1 || n % 4 == 2) ++result[n][at(directions[0])];
      if (n % 4 >= 2) ++result[n][at(directions[1])];
      if (n >= 4 && dimension_ == 3) ++result[n][at(directions[2])];
    }
    return result;
  }

  int dimension_, side_, layers_;
  double core_;  ///< half the core's width between the middles of its faces
};

/// Nodes by name, numbered as they come.
class NamedNodes {
 public:
  template <class Place>
  int number(const std::array<int, 5>& name, Place&& place) {
    const auto [entry, fresh] = number_.try_emplace(name, static_cast<int>(grid.nodes.size()));
    if (fresh) {
      const auto [X, surface] = place();
      grid.nodes.push_back(X);
      on_surface.push_back(surface ? 1 : 0);
    }
    return entry->second;
  }

  HexahedronGrid grid;
  std::vector<char> on_surface;

 private:
  std::map<std::array<int, 5>, int> number_;
};

struct Placed {
  Vec3d X;
  bool on_surface;
};

}  // namespace

ElementMesh generate_cylinder(const Vec3d& from, const Vec3d& to, double radius, const std::array<int, 2>& cells,
                              const ElementKind& kind) {
  check_kind(kind);
  const double length = norm(to - from);
  if (!std::isfinite(length) || !(length > 0)) throw InputError("the cylinder's ends coincide; must differ");
  if (!std::isfinite(radius) || !(radius > 0)) throw InputError("the cylinder's radius must be above 0");
  check_cells("cells along the axis", cells[0]);
  check_around(cells[1]);
  const int side = cells[1] / 4, layers = std::max(1, (side + 1) / 3);
  check_total(double(cells[0]) * side * (side + 4.0 * layers));

  // Axes across: the next coordinate axis after the one that the cylinder follows most closely comes first.
  const Vec3d axis = (to - from) * (1 / length);
  int along = 2;
  for (const int c : {1, 0})
    if (std::abs(axis[c]) > std::abs(axis[along]) * (1 + 1e-12)) along = c;
  Vec3d e1;
  e1[(along + 1) % 3] = 1;
  e1 = normalized(e1 - axis * dot(axis, e1));
  const Vec3d e2 = cross(axis, e1);

  const OGrid plane(2, side, layers);
  NamedNodes nodes;
  for (int level = 0; level < cells[0]; ++level)
    plane.for_each_cell([&](const std::array<OGrid::Name, 8>& corners) {
      std::array<int, 8> cell{};
      for (std::size_t n = 0; n < 8; ++n) {
        const OGrid::Name& name = corners[n];
        const int height = level + (n >= 4 ? 1 : 0);
        cell[n] = nodes.number({name[0], name[1], name[2], name[3], height}, [&]() -> Placed {
          const Vec3d p = plane.place(name);
          const Vec3d center = height == cells[0] ? to : from + (to - from) * (static_cast<double>(height) / cells[0]);
          return {center + (e1 * p[0] + e2 * p[1]) * radius, plane.on_surface(name)};
        });
      }
      nodes.grid.cells.push_back(cell);
    });
  return with_order(elements_of(nodes.grid, kind), kind, nodes.on_surface, [&](const Vec3d& X) {
    const Vec3d on_axis = from + axis * dot(axis, X - from);
    return on_axis + normalized(X - on_axis) * radius;
  });
}

ElementMesh generate_ellipsoid(const Vec3d& center, const Vec3d& radii, const std::array<int, 2>& cells,
                               const ElementKind& kind) {
  check_kind(kind);
  for (int c = 0; c < 3; ++c)
    if (!std::isfinite(radii[c]) || !(radii[c] > 0))
      throw InputError(std::string("the ellipsoid's radius along ") + "xyz"[c] + " must be above 0");
  check_around(cells[0]);
  check_cells("layers of cells", cells[1]);
  const int side = cells[0] / 4;
  check_total(double(side) * side * (side + 6.0 * cells[1]));

  const auto stretch = [&](const Vec3d& p) {
    return center + Vec3d{{p[0] * radii[0], p[1] * radii[1], p[2] * radii[2]}};
  };
  const OGrid ball(3, side, cells[1]);
  NamedNodes nodes;
  ball.for_each_cell([&](const std::array<OGrid::Name, 8>& corners) {
    std::array<int, 8> cell{};
    for (std::size_t n = 0; n < 8; ++n) {
      const OGrid::Name& name = corners[n];
      cell[n] = nodes.number({name[0], name[1], name[2], name[3], 0}, [&]() -> Placed {
        return {stretch(ball.place(name)), ball.on_surface(name)};
      });
    }
    nodes.grid.cells.push_back(cell);
  });
  return with_order(elements_of(nodes.grid, kind), kind, nodes.on_surface, [&](const Vec3d& X) {
    const Vec3d d = X - center;
    return stretch(normalized(Vec3d{{d[0] / radii[0], d[1] / radii[1], d[2] / radii[2]}}));
  });
}

}  // namespace fascia
