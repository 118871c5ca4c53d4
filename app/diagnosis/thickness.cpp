#include "app/diagnosis/thickness.hpp"

#include "assembly/specification/readable.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {

namespace {

constexpr double kSlender = 4;  ///< size over thickness, from which a body bends rather than shears

double area_of(const TriangleMesh& surface) {
  double area = 0;
  for (const auto& t : surface.triangles)
    area += 0.5 * norm(cross(surface.points[at(t[1])] - surface.points[at(t[0])],
                             surface.points[at(t[2])] - surface.points[at(t[0])]));
  return area;
}

/// Mean length of the edges of the cells [m].
double spacing_of(const SimulatedBody& b) {
  const BodyCells& cells = b.body->cells();
  const std::size_t count = cells.nodes.size() / at(cells.nodes_per_cell);
  const double volume = b.body->volume() / static_cast<double>(count);
  return std::cbrt(cells.type == CellType::tetrahedron ? 6 * volume : volume);
}

}  // namespace

std::string thickness_line(const Simulation& s, std::size_t index) {
  const Body& body = s.scene.bodies[index];
  const SimulatedBody& b = s.bodies[index];
  if (!is_mesh_model(body) || body.order != 1) return "";
  if (std::find(b.node_on_boundary.begin(), b.node_on_boundary.end(), 0) != b.node_on_boundary.end()) return "";
  // 4V/A is the thickness of a square bar and twice that of a plate, whose bounding box knows better.
  const Vec3d extent = bounds_of(b.nodes).extent();
  const double thickness =
      std::min({extent[0], extent[1], extent[2], 4 * b.body->volume() / area_of(b.body->surface())});
  if (b.body->size() < kSlender * thickness) return "";
  return fmt::format(
      "one {} of about {} through its thickness of about {}: where the body bends, elements of order 1 lock and make "
      "it "
      "much too stiff; use order = 2, more cells through the thickness, or model = \"shell\"",
      body.model == BodyModel::tetrahedra ? "tetrahedron" : "hexahedron", length_text(spacing_of(b)),
      length_text(thickness));
}

}  // namespace fascia::app
