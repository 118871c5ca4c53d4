#include "assembly/bodies/bodies.hpp"

#include "assembly/bodies/domains.hpp"
#include "assembly/bodies/read_files.hpp"
#include "assembly/simulation/regions.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/errors.hpp"
#include "core/math/rotation.hpp"
#include "fem/element_body.hpp"
#include "fem/from_mesh.hpp"
#include "fem/generate.hpp"
#include "fem/refine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

/// Bodies of finite elements: the mesh of a domain, and what the elements are made of.
namespace fascia {

namespace {

template <std::size_t N>
std::array<int, N> cells_of(const Body& body) {
  std::array<int, N> cells{};
  std::copy(body.cells->count.begin(), body.cells->count.end(), cells.begin());
  return cells;
}

ElementMesh mesh_of(const Body& body) {
  const ElementFamily family =
      body.model == BodyModel::tetrahedra ? ElementFamily::tetrahedra : ElementFamily::hexahedra;
  if (const auto* file = std::get_if<FileDomain>(&body.domain)) {
    ElementMesh mesh = element_mesh(read_for(file->place, file->path, file->read, MidNodes::keep), family, body.order);
    check_refinement(*file, mesh.size(), 8);
    for (int k = 0; k < file->refine; ++k) mesh = refined(mesh);
    return mesh;
  }
  const ElementKind kind{family, body.order, body.cells->split};
  if (const auto* box = std::get_if<BoxDomain>(&body.domain))
    return generate_box(box->min, box->max, cells_of<3>(body), kind);
  if (const auto* block = std::get_if<BlockDomain>(&body.domain))
    return generate_block(block->corners, cells_of<3>(body), kind);
  if (const auto* cylinder = std::get_if<CylinderDomain>(&body.domain))
    return generate_cylinder(cylinder->from, cylinder->to, cylinder->radius, cells_of<2>(body), kind);
  const auto& ellipsoid = std::get<EllipsoidDomain>(body.domain);
  return generate_ellipsoid(ellipsoid.center, ellipsoid.radii, cells_of<2>(body), kind);
}

double volume_of(const ElementMesh& mesh) {
  double volume = 0;
  for (std::size_t e = 0; e < mesh.size(); ++e) volume += element_volume(mesh, e);
  return volume;
}

/// @throws InputError  a translation beside which the elements vanish
void place(const Transform& transform, ElementMesh& mesh) {
  const double expected = volume_of(mesh) * std::pow(transform.scale, 3);
  const Mat3d R =
      transform.angle != 0 ? rotation_about(normalized(transform.axis), transform.angle) : Mat3d::identity();
  for (Vec3d& x : mesh.nodes) x = R * (x * transform.scale) + transform.translate;
  const double volume = volume_of(mesh);
  if (!(std::abs(volume - expected) <= 1e-6 * expected) || !(volume > 0) || !std::isfinite(volume))
    throw InputError(
        fmt::format("rounding changes the volume from {:.6g} to {:.6g} m3 where the transform puts the mesh; "
                    "use a smaller translate or a scale nearer to 1",
                    expected, volume));
}

/// The first entry that selects an element, by its middle or its groups.
std::function<const Material&(const Vec3d&, int)> material_of(const Body& body, const ElementMesh& mesh,
                                                              const std::vector<BodyGroup>& groups,
                                                              std::vector<bool>& used) {
  std::vector<Vec3d> middles;
  std::vector<int> cells;
  middles.reserve(mesh.size());
  cells.reserve(mesh.size());
  for (std::size_t e = 0; e < mesh.size(); ++e) {
    middles.push_back(element_middle(mesh, e));
    cells.push_back(static_cast<int>(e));
  }
  std::vector<std::vector<bool>> chosen;  // by entry and element
  for (const MaterialUse& use : body.materials) {
    require_material(use.where);
    chosen.push_back(select(use.where, {middles, {}, &groups, cells}));
  }
  return [&body, &used, chosen = std::move(chosen)](const Vec3d& X, int element) -> const Material& {
    for (std::size_t i = 0; i < body.materials.size(); ++i) {
      const MaterialUse& use = body.materials[i];
      if (!chosen[i][static_cast<std::size_t>(element)]) continue;
      used[i] = true;
      return use.material;
    }
    throw SceneError({{body.materials.back().where.place,
                       fmt::format("no material at ({:.6g}, {:.6g}, {:.6g}); let the last entry of material "
                                   "have no where",
                                   X[0], X[1], X[2])}});
  };
}

/// Why a material's region holds nothing.
std::string unused_region(const Region& region, const std::vector<BodyGroup>& groups) {
  if (!std::holds_alternative<GroupRegion>(region.shape)) return "the region holds no element of the body; enlarge it";
  std::string names;
  for (const BodyGroup& g : groups)
    if (!g.cells.empty()) names += (names.empty() ? "\"" : ", \"") + g.name + "\"";
  return "the group holds no element of the body; " +
         (names.empty() ? "the mesh has no groups of volume cells" : "groups of volume cells are " + names);
}

/// What the blamed key said.
template <class Build>
std::unique_ptr<ModelBody> blaming(const Place& place, const Build& build) {
  try {
    return build();
  } catch (const InputError& e) {
    throw SceneError({{place, e.what()}});
  }
}

}  // namespace

std::unique_ptr<ModelBody> build_element_body(const Body& body, Model& model, PointSetBuilder& points) {
  ElementBodySpec spec;
  spec.mesh = mesh_of(body);
  place(body.transform, spec.mesh);
  spec.formulation = body.formulation == Formulation::linear         ? ElementFormulation::linear
                     : body.formulation == Formulation::corotational ? ElementFormulation::corotational
                                                                     : ElementFormulation::large_strain;
  spec.locking = body.locking == Locking::f_bar  ? ElementLocking::averaged
                 : body.locking == Locking::none ? ElementLocking::none
                                                 : ElementLocking::automatic;
  spec.penalty = body.incompressibility;
  spec.density = body.density ? *body.density : *body.mass / volume_of(spec.mesh);
  const std::vector<BodyGroup> groups = body_groups(spec.mesh);
  std::vector<bool> used(body.materials.size());
  const auto chosen = material_of(body, spec.mesh, groups, used);
  spec.material = [chosen](const Vec3d& X, int element) { return point_material(chosen(X, element)); };
  if (std::any_of(body.materials.begin(), body.materials.end(),
                  [](const MaterialUse& use) { return use.material.activation.has_value(); }))
    spec.active = [chosen](const Vec3d& X, int element) { return active_stress(chosen(X, element), X); };
  const Place& place = body.locking == Locking::automatic ? body.place : body.locking_place;
  std::unique_ptr<ModelBody> built =
      blaming(place, [&] { return std::make_unique<ElementBody>(std::move(spec), model, points); });
  for (std::size_t i = 0; i < used.size(); ++i)
    if (!used[i]) throw SceneError({{body.materials[i].where.place, unused_region(body.materials[i].where, groups)}});
  return built;
}

SampleEstimate estimated_elements(const Body& body) {
  SampleEstimate e;
  const bool hexahedra = body.model == BodyModel::hexahedra, quadratic = body.order == 2;
  double cells = 0;
  if (body.cells) {
    cells = 1;
    for (const int n : body.cells->count) cells *= n;
    if (body.cells->count.size() == 2) cells *= body.cells->count[0];  // round domains
  }
  e.points = cells * (hexahedra    ? (quadratic ? 27 : 8)
                      : body.cells ? body.cells->split * (quadratic ? 4.0 : 1.0)
                                   : 0.0);
  e.frames = cells * (quadratic ? (hexahedra ? 4 : 8) : 1);
  e.neighbours = quadratic ? (hexahedra ? 20 : 10) : hexahedra ? 8 : 4;
  e.coupled = quadratic ? 60 : hexahedra ? 27 : 15;
  return e;
}

}  // namespace fascia
