#include "assembly/bodies/bodies.hpp"

#include "assembly/bodies/carried_surface.hpp"
#include "assembly/bodies/domains.hpp"
#include "assembly/bodies/read_files.hpp"
#include "assembly/bodies/shell_meshes.hpp"
#include "assembly/simulation/regions.hpp"
#include "assembly/specification/errors.hpp"
#include "coupling/rigid_body.hpp"
#include "coupling/surface_body.hpp"
#include "fem/generate.hpp"
#include "meshless/cloud_parts.hpp"
#include "meshless/grid_body.hpp"
#include "shells/shell_body.hpp"
#include "shells/surface_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

constexpr double kDrilling = 0.1, kAffineStabilization = 0.003;

}  // namespace

PointMaterialSpec point_material(const Material& m) { return {m, m.mass_damping, m.stiffness_damping, m.law}; }

std::shared_ptr<const ActiveStress> active_stress(const Material& m, const Vec3d& X) {
  if (!m.activation) return nullptr;
  const Vec3d along = fibre_direction(m.fibres[m.activation->fibres], X);
  return std::make_shared<const ActiveStress>(ActiveStress::along(along, m.activation->stress, m.activation->factor));
}

namespace {

/// A single-material spec, or a choice by region.
std::function<PointMaterialSpec(const Vec3d&)> material_of(const Body& body, double size) {
  return [&body, size](const Vec3d& X) {
    for (const MaterialUse& use : body.materials)
      if (contains(use.where, X, size)) {
        PointMaterialSpec at_point = point_material(use.material);
        at_point.active = active_stress(use.material, X);
        return at_point;
      }
    throw SceneError(
        {{body.place,
          fmt::format("no material at ({}, {}, {}); let the last entry of material have no where", X[0], X[1], X[2])}});
  };
}

void check_material_regions(const Body& body, const ModelBody& built) {
  for (const MaterialUse& use : body.materials) {
    const auto& points = built.points();
    if (!std::any_of(points.begin(), points.end(),
                     [&](const BodyPoint& p) { return contains(use.where, p.middle, built.size()); }))
      throw SceneError({{use.where.place, "the region holds no integration point of the body; enlarge it"}});
  }
}

void fill_matter(const Body& body, const MatterParts& parts, double volume, BodyMatter& matter) {
  const bool consistent = body.weights == WeightKind::automatic || body.weights == WeightKind::trilinear ||
                          body.weights == WeightKind::linear || body.weights == WeightKind::mls;
  matter.affine = body.affine;
  matter.half_blend = body.blend == Blend::half || (body.blend == Blend::automatic && consistent);
  matter.stabilization = body.drilling.value_or(body.affine ? kAffineStabilization : kDrilling);
  matter.density = body.density ? *body.density : *body.mass / volume;
  matter.material = material_of(body, size_of(parts));
}

std::unique_ptr<ModelBody> build_grid(const Body& body, const MatterParts& parts, BodyBuild& build) {
  GridSpec spec;
  spec.shared = build.shared;
  spec.domain = *parts.solid;
  const std::vector<int>& count = std::get<GridFrames>(body.frames).count;
  std::copy(count.begin(), count.end(), spec.grid.begin());
  if (const auto* cell = std::get_if<PerCell>(&body.points)) {
    spec.per_cell.emplace();
    std::copy(cell->count.begin(), cell->count.end(), spec.per_cell->begin());
  }
  spec.weights = body.weights == WeightKind::linear ? GridWeightKind::linear : GridWeightKind::trilinear;
  spec.integration = body.integration == Integration::automatic ? IntegrationKind::automatic
                     : body.integration == Integration::full    ? IntegrationKind::full
                                                                : IntegrationKind::selective;
  spec.rotation = parts.rotation;
  spec.translation = parts.translation;
  fill_matter(body, parts, spec.domain.volume, spec);
  return std::make_unique<GridBody>(spec, build.model, build.points);
}

/// Positions that a user gives are rest positions; samplers work before the placement.
std::vector<Vec3d> before_placement(const MatterParts& parts, std::vector<Vec3d> positions) {
  for (Vec3d& x : positions) x = transpose(parts.rotation) * (x - parts.translation);
  return positions;
}

template <class Choice>
SampleChoice sample_choice(const Choice& choice, const MatterParts& parts, const Place& place) {
  if (const auto* spaced = std::get_if<SpacedSamples>(&choice)) return SpacedChoice{spaced->spacing, spaced->seed};
  if (const auto* counted = std::get_if<CountedSamples>(&choice)) return CountedChoice{counted->count, counted->seed};
  if (const auto* file = std::get_if<SampleFile>(&choice)) {
    PointTable table = read_for(place, file->path, file->read);
    return ListedChoice{before_placement(parts, std::move(table.position)), table.rotation, table.volume};
  }
  return {};
}

SampleChoice frame_choice(const Body& body, const MatterParts& parts) {
  if (const auto* listed = std::get_if<ListedFrames>(&body.frames))
    return ListedChoice{before_placement(parts, listed->positions), listed->rotations, {}};
  return sample_choice(body.frames, parts, body.frames_place);
}

ScatteredKind scattered_kind(WeightKind kind) {
  switch (kind) {
    case WeightKind::shepard:
      return ScatteredKind::shepard;
    case WeightKind::wendland:
      return ScatteredKind::wendland;
    case WeightKind::cubic_spline:
      return ScatteredKind::cubic_spline;
    default:
      return ScatteredKind::mls;
  }
}

/// What a user may not have meant.
void warn_of_thin_choices(const Body& body, const ModelBody& built, std::vector<std::string>& messages) {
  double extent = 2 * body.radius.value_or(0);
  for (const ThicknessUse& use : body.thickness) extent = std::max(extent, use.value);
  if (extent > 0.5 * built.size())
    messages.push_back(fmt::format("is {:.3g} m thick and {:.3g} m across; write lengths with their unit, as \"2 mm\"",
                                   extent, built.size()));
  if (body.through == 1)
    messages.push_back(
        "points.through = 1 is the 2014 paper's rule: nothing resists bending and torsion but an artefact "
        "of the spacing");
}

void describe_thin_grid(const Body& body, const MatterParts& parts, const BodyBuild& build, CloudSpec& spec) {
  ThinGridSpec thin;
  thin.shared = build.shared;
  thin.threads = build.threads;
  thin.store = build.store;
  thin.parts = parts;
  thin.grid.count = std::get<GridFrames>(body.frames).count;
  const double scale = body.transform.scale;
  if (const auto* r = std::get_if<RectangleDomain>(&body.domain)) {
    thin.grid.origin = r->origin * scale;
    thin.grid.edge = {r->edge_u * scale, r->edge_v * scale};
    thin.extent = [&body, size = size_of(parts)](const Vec3d& X) { return thickness_at(body, X, size); };
  } else {
    const auto& line = std::get<LineDomain>(body.domain);
    thin.grid.origin = line.from * scale;
    thin.grid.edge = {(line.to - line.from) * scale};
    thin.extent = [&body](const Vec3d&) { return *body.radius; };
  }
  if (const auto* cell = std::get_if<PerCell>(&body.points))
    thin.per_cell = cell->count;
  else
    thin.points = sample_choice(body.points, parts, body.points_place);
  grid_cloud(thin, spec);
}

std::unique_ptr<ModelBody> build_shell(const Body& body, BodyBuild& build) {
  ShellBodySpec spec;
  spec.mesh = shell_mesh_of(body);
  spec.thickness = shell_thickness(body, spec.mesh);
  build.messages = thickness_warnings(spec.mesh, spec.thickness);
  for (const MaterialUse* use : shell_materials(body, spec.mesh))
    spec.material.push_back(point_material(use->material));
  double volume = 0;
  for (std::size_t t = 0; t < spec.thickness.size(); ++t) volume += spec.thickness[t] * area(spec.mesh, t);
  spec.density = body.density ? *body.density : *body.mass / volume;
  return std::make_unique<ShellBody>(std::move(spec), build.model, build.points);
}

std::unique_ptr<ModelBody> build_rigid(const Body& body, BodyBuild& build) {
  CarriedSurface carried = carried_surface(body);
  build.messages = std::move(carried.messages);
  const bool closed = carried.closed;
  if (body.density && !closed)
    throw SceneError({{body.domain_place,
                       "the surface is open and encloses no volume; give the body a mass in place "
                       "of a density"}});
  return std::make_unique<RigidBody>(
      RigidBodySpec{std::move(carried.mesh), closed, body.mass, body.density, body.inertia}, build.model, build.points);
}

/// Nodes and triangles of a generated surface.
SampleEstimate estimated_triangles(const Body& body) {
  SampleEstimate e;
  if (!body.cells) return e;
  const std::vector<int>& count = body.cells->count;
  e.frames = count.size() == 2 ? 1.0 * count[0] * count[1] : 0.25 * count[0] * count[0];
  e.points = 2 * e.frames;
  e.neighbours = 3;
  e.coupled = 7;
  return e;
}

}  // namespace

std::unique_ptr<ModelBody> build_body(const Body& body, BodyBuild& build) {
  if (is_mesh_model(body)) return build_element_body(body, build.model, build.points);
  if (is_shell(body)) return build_shell(body, build);
  if (body.model == BodyModel::rigid) return build_rigid(body, build);
  if (body.model == BodyModel::surface) {
    CarriedSurface carried = carried_surface(body);
    build.messages = std::move(carried.messages);
    return std::make_unique<SurfaceBody>(std::move(carried.mesh), build.model);
  }
  const Body local = near_origin(body);
  const MatterParts parts = build.between ? *build.between : make_domain(local, build.messages);
  const bool grid = std::holds_alternative<GridFrames>(body.frames);
  std::unique_ptr<ModelBody> built;
  if (grid && parts.dimension() == 3) {
    built = build_grid(body, parts, build);
  } else {
    CloudSpec spec;
    spec.through = body.through.value_or(0);
    if (grid) {
      describe_thin_grid(local, parts, build, spec);
    } else {
      ScatterSpec scatter{parts,
                          frame_choice(body, parts),
                          sample_choice(body.points, parts, body.points_place),
                          scattered_kind(body.weights),
                          body.neighbours,
                          body.support,
                          build.shared,
                          build.threads,
                          build.store};
      scatter_cloud(scatter, spec, build.messages);
    }
    double volume = 0;
    for (const CloudPoint& p : spec.points) volume += p.volume;
    fill_matter(body, parts, volume, spec);
    built = std::make_unique<CloudBody>(spec, build.model, build.points);
    warn_of_thin_choices(body, *built, build.messages);
  }
  if (body.blend == Blend::full && body.drilling.value_or(1) > 0)
    build.messages.push_back("blend = \"full\" with a drilling stiffness locks; add drilling = 0 to weights");
  check_material_regions(body, *built);
  return built;
}

namespace {

double product(const std::vector<int>& numbers) {
  double p = 1;
  for (const int n : numbers) p *= n;
  return p;
}

/// Length, area or volume of a domain that needs no file; 0 of others.
double measure_of(const Body& body) {
  const double scale = body.transform.scale;
  if (const auto* box = std::get_if<BoxDomain>(&body.domain)) {
    const Vec3d size = (box->max - box->min) * scale;
    return size[0] * size[1] * size[2];
  }
  if (const auto* c = std::get_if<CylinderDomain>(&body.domain))
    return 3.15 * c->radius * c->radius * norm(c->to - c->from) * std::pow(scale, 3);
  if (const auto* e = std::get_if<EllipsoidDomain>(&body.domain))
    return 4.2 * e->radii[0] * e->radii[1] * e->radii[2] * std::pow(scale, 3);
  if (const auto* r = std::get_if<RectangleDomain>(&body.domain))
    return norm(cross(r->edge_u, r->edge_v)) * scale * scale;
  if (const auto* l = std::get_if<LineDomain>(&body.domain)) return norm(l->to - l->from) * scale;
  if (const auto* a = std::get_if<AnnulusDomain>(&body.domain))
    return 0.5 * (a->angle[1] - a->angle[0]) * (a->outer * a->outer - a->inner * a->inner) * scale * scale;
  if (const auto* b = std::get_if<BlockDomain>(&body.domain))
    return element_volume(generate_block(b->corners, {1, 1, 1}, {}), 0) * std::pow(scale, 3);
  return 0;
}

}  // namespace

SampleEstimate estimated_samples(const Body& body) {
  if (is_mesh_model(body)) return estimated_elements(body);
  if (is_shell(body)) return estimated_triangles(body);
  SampleEstimate e;
  const bool line = std::holds_alternative<LineDomain>(body.domain);
  const bool sheet = std::holds_alternative<RectangleDomain>(body.domain) || !body.thickness.empty();
  const int dimension = line ? 1 : sheet ? 2 : 3;
  const double virtual_points = line ? 4 : sheet ? body.through.value_or(2) : 1;
  if (const auto* grid = std::get_if<GridFrames>(&body.frames)) {
    const auto* given = std::get_if<PerCell>(&body.points);
    e.frames = product(grid->count);
    e.points = virtual_points;
    for (std::size_t a = 0; a < grid->count.size(); ++a)
      e.points *= 1.0 * (grid->count[a] - 1) * (given ? given->count[a] : grid->count[a] == 2 ? 3 : 2);
  } else {
    e.neighbours = dimension == 3 ? 36 : dimension == 2 ? 20 : 6;
    e.coupled = dimension == 3 ? 120 : dimension == 2 ? 40 : 8;
    const double measure = measure_of(body);
    if (const auto* spaced = std::get_if<SpacedSamples>(&body.frames))
      e.frames = measure / std::pow(spaced->spacing, dimension);
    if (const auto* counted = std::get_if<CountedSamples>(&body.frames)) e.frames = counted->count;
    if (const auto* listed = std::get_if<ListedFrames>(&body.frames))
      e.frames = static_cast<double>(listed->positions.size());
    e.points = e.frames * std::pow(2, dimension) * virtual_points;
    e.pieces = std::min(4e6, e.points * std::pow(6, dimension));
  }
  if (const auto* counted = std::get_if<CountedSamples>(&body.points)) e.points = counted->count * virtual_points;
  return e;
}

}  // namespace fascia
