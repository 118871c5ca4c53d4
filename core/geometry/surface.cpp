#include "core/geometry/surface.hpp"

#include "core/base/errors.hpp"
#include "core/geometry/surface_parts.hpp"

namespace fascia {

ClosedSurface closed_surface(const Mesh& mesh) {
  using namespace surface_parts;
  check_points(mesh);
  const bool volume_mesh = count_cells(mesh, is_volume) > 0;
  if (!volume_mesh && count_cells(mesh, is_surface) == 0)
    throw InputError(mesh.file + ": has neither volume cells nor triangles; give a closed surface or a volume mesh");

  std::vector<std::string> messages = mesh.messages;
  report_unused(mesh, messages);
  const Solid solid = make_solid(mesh, volume_mesh ? is_volume : is_surface, messages);
  std::vector<Triangle> triangles =
      volume_mesh ? boundary_of_cells(solid, messages) : triangles_of_cells(solid, Surface::of_solid, messages);
  check_closed(solid, triangles, messages);
  if (!volume_mesh) orient_outward(solid, triangles, messages);

  ClosedSurface result = enclose(solid, triangles);
  result.messages = std::move(messages);
  return result;
}

std::vector<std::string> turn_cavities(const std::string& file, OfOverlap overlap, TriangleMesh& closed) {
  surface_parts::Solid solid;
  solid.file = file;
  solid.points = closed.points;
  std::vector<surface_parts::Triangle> triangles;
  triangles.reserve(closed.triangles.size());
  for (const std::array<int, 3>& nodes : closed.triangles) triangles.push_back({nodes});
  std::vector<std::string> messages;
  surface_parts::turn_cavities(solid, overlap, triangles, messages);
  for (std::size_t t = 0; t < triangles.size(); ++t) closed.triangles[t] = triangles[t].nodes;
  return messages;
}

}  // namespace fascia
