#include "assembly/bodies/shell_meshes.hpp"

#include "assembly/bodies/domains.hpp"
#include "assembly/bodies/read_files.hpp"
#include "assembly/simulation/regions.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/errors.hpp"
#include "core/math/rotation.hpp"
#include "shells/generate.hpp"
#include "shells/refine.hpp"
#include "shells/surface_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

std::array<int, 2> two_cells(const Body& body) { return {body.cells->count[0], body.cells->count[1]}; }

Diagonal diagonal_of(const Body& body) {
  switch (body.cells->diagonal) {
    case CellDiagonal::left:
      return Diagonal::left;
    case CellDiagonal::alternating:
      return Diagonal::alternating;
    case CellDiagonal::right:
      break;
  }
  return Diagonal::right;
}

ShellMesh generated_or_read(const Body& body) {
  if (const auto* file = std::get_if<FileDomain>(&body.domain)) {
    ShellMesh mesh = shell_mesh(read_for(file->place, file->path, file->read, MidNodes::keep));
    check_refinement(*file, mesh.triangles.size(), 4);
    for (int k = 0; k < file->refine; ++k) mesh = refined(mesh);
    return mesh;
  }
  if (const auto* r = std::get_if<RectangleDomain>(&body.domain))
    return rectangle(r->origin, r->edge_u, r->edge_v, two_cells(body), diagonal_of(body));
  if (const auto* a = std::get_if<AnnulusDomain>(&body.domain))
    return annulus(a->center, a->normal, a->inner, a->outer, {a->angle[0], a->angle[1], a->closed}, two_cells(body),
                   diagonal_of(body));
  if (const auto* c = std::get_if<CylinderDomain>(&body.domain))
    return cylinder_skin(c->from, c->to, c->radius, {c->angle[0], c->angle[1], c->closed}, c->caps, two_cells(body),
                         diagonal_of(body));
  const auto& ellipsoid = std::get<EllipsoidDomain>(body.domain);
  return ellipsoid_skin(ellipsoid.center, ellipsoid.radii, body.cells->count[0]);
}

/// @throws InputError  a transform beside which the triangles vanish
void place(const Transform& transform, ShellMesh& mesh) {
  const double expected = area(mesh) * transform.scale * transform.scale;
  const Mat3d R =
      transform.angle != 0 ? rotation_about(normalized(transform.axis), transform.angle) : Mat3d::identity();
  for (Vec3d& x : mesh.nodes) x = R * (x * transform.scale) + transform.translate;
  double placed = 0, least = area(mesh, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    placed += area(mesh, t);
    least = std::min(least, area(mesh, t));
  }
  if (!(std::abs(placed - expected) <= 1e-6 * expected) || !(least > 0) || !std::isfinite(placed))
    throw InputError(
        fmt::format("rounding changes the area from {:.6g} to {:.6g} m2 where the surface is placed; use "
                    "smaller coordinates, a smaller translate or a scale nearer to 1",
                    expected, placed));
}

/// Why an entry holds no triangle.
std::string unused_entry(const Region& region, bool selects, const ShellMesh& mesh) {
  if (selects) return "entries before it hold all triangles of the region; remove it or put it before them";
  if (!std::holds_alternative<GroupRegion>(region.shape)) return "the region holds no triangle's centre; enlarge it";
  std::string names;
  for (const BodyGroup& g : mesh.groups)
    if (!g.cells.empty()) names += (names.empty() ? "\"" : ", \"") + g.name + "\"";
  return "the group holds no triangle of the shell; " +
         (names.empty() ? "the mesh has no groups of triangles" : "groups of triangles are " + names);
}

/// For each triangle the first entry of a key whose region selects it.
template <class Use>
std::vector<const Use*> first_matches(const std::vector<Use>& uses, const ShellMesh& mesh, const char* key) {
  const std::size_t count = mesh.triangles.size();
  std::vector<Vec3d> middles(count);
  std::vector<int> cells(count);
  for (std::size_t t = 0; t < count; ++t) {
    middles[t] = middle(mesh, t);
    cells[t] = static_cast<int>(t);
  }
  std::vector<const Use*> result(count, nullptr);
  for (const Use& use : uses) {
    require_material(use.where);
    const std::vector<bool> chosen = select(use.where, {middles, {}, &mesh.groups, cells});
    bool selects = false, used = false;
    for (std::size_t t = 0; t < count; ++t) {
      if (!chosen[t]) continue;
      selects = true;
      if (result[t]) continue;
      result[t] = &use;
      used = true;
    }
    if (!used) throw SceneError({{use.where.place, unused_entry(use.where, selects, mesh)}});
  }
  const auto none = std::find(result.begin(), result.end(), nullptr);
  if (none != result.end())
    throw SceneError(
        {{uses.back().where.place, fmt::format("no {} for {}; let the last entry of {} have no where", key,
                                               name_of(mesh, static_cast<std::size_t>(none - result.begin())), key)}});
  return result;
}

}  // namespace

ShellMesh shell_mesh_of(const Body& body) {
  ShellMesh mesh = generated_or_read(body);
  place(body.transform, mesh);
  const ShellQuality quality = shell_quality(mesh);
  mesh.messages.insert(mesh.messages.end(), quality.messages.begin(), quality.messages.end());
  return mesh;
}

std::vector<double> shell_thickness(const Body& body, const ShellMesh& mesh) {
  std::vector<double> thickness;
  for (const ThicknessUse* use : first_matches(body.thickness, mesh, "thickness")) thickness.push_back(use->value);
  return thickness;
}

std::vector<const MaterialUse*> shell_materials(const Body& body, const ShellMesh& mesh) {
  return first_matches(body.materials, mesh, "material");
}

}  // namespace fascia
