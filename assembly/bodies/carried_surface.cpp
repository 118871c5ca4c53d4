#include "assembly/bodies/carried_surface.hpp"

#include "assembly/bodies/shell_meshes.hpp"
#include "core/geometry/primitives.hpp"
#include "core/geometry/surface.hpp"
#include "core/math/rotation.hpp"
#include "shells/surface_checks.hpp"

#include <algorithm>

namespace fascia {

namespace {

/// Skin of a tapered box: the faces of its cells that one cell has, cut in two.
TriangleMesh block_surface(const BlockDomain& block, const std::array<int, 3>& cells) {
  TriangleMesh mesh = box_surface({{0, 0, 0}}, {{1, 1, 1}}, cells[0], cells[1], cells[2]);
  for (Vec3d& x : mesh.points) {
    Vec3d mapped;
    for (std::size_t k = 0; k < 8; ++k) {
      const bool right = k % 4 == 1 || k % 4 == 2, back = k % 4 >= 2, top = k >= 4;
      mapped += block.corners[k] * ((right ? x[0] : 1 - x[0]) * (back ? x[1] : 1 - x[1]) * (top ? x[2] : 1 - x[2]));
    }
    x = mapped;
  }
  return mesh;
}

std::array<int, 3> cells_along(const Body& body) {
  std::array<int, 3> cells{1, 1, 1};
  if (body.cells)
    std::copy_n(body.cells->count.begin(), std::min<std::size_t>(3, body.cells->count.size()), cells.begin());
  return cells;
}

void place(const Transform& transform, TriangleMesh& mesh) {
  const Mat3d R =
      transform.angle != 0 ? rotation_about(normalized(transform.axis), transform.angle) : Mat3d::identity();
  for (Vec3d& x : mesh.points) x = R * (x * transform.scale) + transform.translate;
}

}  // namespace

CarriedSurface carried_surface(const Body& body) {
  CarriedSurface carried;
  if (const auto* box = std::get_if<BoxDomain>(&body.domain)) {
    const std::array<int, 3> cells = cells_along(body);
    carried.mesh = box_surface(box->min, box->max, cells[0], cells[1], cells[2]);
    carried.closed = true;
    place(body.transform, carried.mesh);
    return carried;
  }
  if (const auto* block = std::get_if<BlockDomain>(&body.domain)) {
    carried.mesh = block_surface(*block, cells_along(body));
    carried.closed = true;
    place(body.transform, carried.mesh);
    return carried;
  }
  ShellMesh mesh = shell_mesh_of(body);
  carried.closed = closed(mesh);
  carried.mesh = {std::move(mesh.nodes), std::move(mesh.triangles)};
  carried.messages = std::move(mesh.messages);
  if (body.model == BodyModel::rigid && carried.closed && !mesh.file.empty())
    for (std::string& message :
         turn_cavities(mesh.file, body.density ? OfOverlap::is_refused : OfOverlap::is_told, carried.mesh))
      carried.messages.push_back(std::move(message));
  return carried;
}

}  // namespace fascia
