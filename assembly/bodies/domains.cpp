#include "assembly/bodies/domains.hpp"

#include "assembly/bodies/read_files.hpp"
#include "assembly/simulation/regions.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/mesh_parts.hpp"
#include "core/geometry/primitives.hpp"
#include "core/geometry/surface.hpp"
#include "core/math/rotation.hpp"
#include "fem/generate.hpp"
#include "meshless/cloud_parts.hpp"
#include "shells/generate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace fascia {

namespace {

constexpr double kPi = std::numbers::pi;

void set_bounds(SolidDomain& solid) {
  solid.min = solid.max = solid.surface.points.front();
  for (const Vec3d& p : solid.surface.points) {
    for (int a = 0; a < 3; ++a) {
      solid.min[a] = std::min(solid.min[a], p[a]);
      solid.max[a] = std::max(solid.max[a], p[a]);
    }
  }
}

void add_distance(SolidDomain& solid) {
  const auto test = std::make_shared<const InsideTest>(solid.surface);
  solid.distance = [test, contains = solid.contains](const Vec3d& x) { return contains(x) ? 0.0 : test->distance(x); };
}

/// Cells of the faces that are carried along: those of a frame grid, else a few dozen along the longest edge.
std::array<int, 3> face_cells(const Body& body, const Vec3d& size) {
  std::array<int, 3> cells{};
  const auto* grid = std::get_if<GridFrames>(&body.frames);
  const double longest = std::max({size[0], size[1], size[2]});
  for (std::size_t a = 0; a < 3; ++a)
    cells[a] = grid ? grid->count[a] - 1
                    : std::max(1, static_cast<int>(std::lround(32 * size[static_cast<int>(a)] / longest)));
  return cells;
}

SolidDomain make_box(const BoxDomain& b, const Body& body) {
  const double scale = body.transform.scale;
  SolidDomain solid;
  solid.min = b.min * scale;
  solid.max = b.max * scale;
  const Vec3d size = solid.max - solid.min;
  solid.volume = size[0] * size[1] * size[2];
  const std::array<int, 3> cells = face_cells(body, size);
  solid.surface = box_surface(solid.min, solid.max, cells[0], cells[1], cells[2]);
  return solid;
}

SolidDomain make_cylinder(const CylinderDomain& c, const Body& body) {
  const double scale = body.transform.scale;
  SolidDomain solid;
  const Vec3d from = c.from * scale, to = c.to * scale;
  const double radius = c.radius * scale, length = norm(to - from);
  const Vec3d axis = normalized(to - from);
  solid.volume = kPi * radius * radius * length;
  solid.contains = [=](const Vec3d& x) {
    const double along = dot(x - from, axis);
    return along >= 0 && along <= length && norm(x - from - axis * along) <= radius;
  };
  const auto* grid = std::get_if<GridFrames>(&body.frames);
  const int most = grid ? std::clamp(*std::max_element(grid->count.begin(), grid->count.end()), 9, 200) : 25;
  solid.surface = cylinder_surface(from, to, radius, 48, 2 * (most - 1));
  add_distance(solid);
  for (int a = 0; a < 3; ++a) {  // exact bounds, which the facets do not reach
    const double reach = radius * std::sqrt(std::max(0.0, 1 - axis[a] * axis[a]));
    solid.min[a] = std::min(from[a], to[a]) - reach;
    solid.max[a] = std::max(from[a], to[a]) + reach;
  }
  return solid;
}

SolidDomain make_ellipsoid(const EllipsoidDomain& e, double scale) {
  SolidDomain solid;
  const Vec3d center = e.center * scale, radii = e.radii * scale;
  solid.volume = 4.0 / 3.0 * kPi * radii[0] * radii[1] * radii[2];
  solid.contains = [=](const Vec3d& x) {
    double sum = 0;
    for (int a = 0; a < 3; ++a) sum += (x[a] - center[a]) * (x[a] - center[a]) / (radii[a] * radii[a]);
    return sum <= 1;
  };
  solid.surface = ellipsoid_surface(center, radii, 16);
  add_distance(solid);
  solid.min = center - radii;
  solid.max = center + radii;
  return solid;
}

SolidDomain make_solid(ClosedSurface closed, double scale) {
  SolidDomain solid;
  solid.volume = closed.volume * scale * scale * scale;
  solid.surface = std::move(closed.mesh);
  for (Vec3d& p : solid.surface.points) p *= scale;
  const auto test = std::make_shared<const InsideTest>(solid.surface);
  solid.contains = [test](const Vec3d& x) { return test->contains(x); };
  solid.contains_on_line = [test](double y, double z, std::span<const double> x, std::span<char> inside) {
    test->contains_on_line(y, z, x, inside);
  };
  solid.distance = [test](const Vec3d& x) { return test->contains(x) ? 0.0 : test->distance(x); };
  set_bounds(solid);
  return solid;
}

/// Has as many facets as carried faces have; the volume is that of the trilinear map.
SolidDomain make_block(const BlockDomain& b, const Body& body) {
  std::array<Vec3d, 8> corners = b.corners;
  for (Vec3d& x : corners) x *= body.transform.scale;
  const Bounds bounds = bounds_of(corners);
  const ElementMesh mesh = generate_block(corners, face_cells(body, bounds.high - bounds.low), {});
  double volume = 0;
  for (std::size_t e = 0; e < mesh.size(); ++e) volume += element_volume(mesh, e);
  return make_solid({boundary_faces(mesh).surface, volume, {}}, 1);
}

SheetPart make_sheet(TriangleMesh mesh, const Body& body, const MatterParts& placement) {
  SheetPart sheet;
  sheet.surface = std::move(mesh);
  const double size = bounds_of(sheet.surface.points).diagonal();
  for (const auto& t : sheet.surface.triangles) {
    Vec3d center;
    for (const int node : t) center += sheet.surface.points[at(node)] * (1.0 / 3);
    sheet.thickness.push_back(thickness_at(body, placement.rotation * center + placement.translation, size));
  }
  return sheet;
}

/// A parallelogram of triangles, fine enough for pictures and for a thickness that varies.
TriangleMesh rectangle_mesh(const RectangleDomain& r, const Body& body, double scale) {
  std::array<int, 2> cells{32, 32};
  if (const auto* grid = std::get_if<GridFrames>(&body.frames))
    for (std::size_t a = 0; a < 2; ++a) cells[a] = 2 * (grid->count[a] - 1);
  TriangleMesh mesh;
  for (int j = 0; j <= cells[1]; ++j)
    for (int i = 0; i <= cells[0]; ++i)
      mesh.points.push_back((r.origin + r.edge_u * (1.0 * i / cells[0]) + r.edge_v * (1.0 * j / cells[1])) * scale);
  for (int j = 0; j < cells[1]; ++j) {
    for (int i = 0; i < cells[0]; ++i) {
      const int a = i + (cells[0] + 1) * j, c = a + cells[0] + 1;
      mesh.triangles.push_back({a, a + 1, c + 1});
      mesh.triangles.push_back({a, c + 1, c});
    }
  }
  return mesh;
}

/// A flat ring, whose thickness makes up for what facets leave of its area.
SheetPart make_ring(const AnnulusDomain& a, const Body& body, const MatterParts& placement) {
  constexpr int kOutward = 8, kAround = 192;
  const double scale = body.transform.scale, turn = a.angle[1] - a.angle[0];
  ShellMesh mesh = annulus(a.center * scale, a.normal, a.inner * scale, a.outer * scale,
                           {a.angle[0], a.angle[1], a.closed}, {kOutward, kAround}, Diagonal::right);
  SheetPart sheet = make_sheet({std::move(mesh.nodes), std::move(mesh.triangles)}, body, placement);
  const double facet = turn / kAround;
  for (double& thickness : sheet.thickness) thickness *= facet / std::sin(facet);
  return sheet;
}

LinePart line_part(const LineDomain& l, const Body& body, double scale) {
  LinePart line;
  line.radius = *body.radius;
  const auto* grid = std::get_if<GridFrames>(&body.frames);
  const int cells = grid ? 2 * (grid->count[0] - 1) : 64;
  for (int i = 0; i <= cells; ++i) {
    line.points.push_back((l.from + (l.to - l.from) * (1.0 * i / cells)) * scale);
    if (i > 0) line.segments.push_back({i - 1, i});
  }
  return line;
}

/// A surface that does not close may be meant as a sheet.
ClosedSurface closed_or_thin(const Mesh& mesh) {
  try {
    return closed_surface(mesh);
  } catch (const InputError& e) {
    const std::string message = e.what();
    if (message.find("hole") == std::string::npos) throw;
    throw InputError(message + ", or give the body a thickness to make it a sheet");
  }
}

/// Solids, sheets and lines of a mesh.
void add_mesh(const Mesh& mesh, const Body& body, MatterParts& parts, std::vector<std::string>& messages) {
  const double scale = body.transform.scale;
  if (body.thickness.empty() && !body.radius) {
    ClosedSurface closed = closed_or_thin(mesh);
    messages.insert(messages.end(), closed.messages.begin(), closed.messages.end());
    parts.solid = make_solid(std::move(closed), scale);
    return;
  }
  MeshParts found = mesh_parts(mesh);
  messages.insert(messages.end(), found.messages.begin(), found.messages.end());
  if (found.solid) parts.solid = make_solid(std::move(*found.solid), scale);
  for (Vec3d& x : found.sheet.points) x *= scale;
  for (Vec3d& x : found.line_points) x *= scale;
  if (!found.sheet.triangles.empty() && body.thickness.empty())
    throw SceneError({{body.domain_place, "the mesh has triangles that bound no solid; give the body a thickness"}});
  if (found.sheet.triangles.empty() && !body.thickness.empty())
    throw SceneError({{body.thickness_place, "the mesh has no triangles outside its solids; remove thickness"}});
  if (found.segments.empty() && body.radius)
    throw SceneError({{body.radius_place, "the mesh has no lines; remove radius"}});
  if (!found.sheet.triangles.empty()) parts.sheets.push_back(make_sheet(std::move(found.sheet), body, parts));
  if (body.radius) parts.lines.push_back({std::move(found.line_points), std::move(found.segments), *body.radius});
}

}  // namespace

double thickness_at(const Body& body, const Vec3d& X, double size) {
  for (const ThicknessUse& use : body.thickness)
    if (contains(use.where, X, size)) return use.value;
  throw SceneError({{body.thickness_place,
                     fmt::format("no thickness at ({}, {}, {}); let the last entry have no where", X[0], X[1], X[2])}});
}

MatterParts solid_parts(TriangleMesh closed, double volume) {
  MatterParts parts;
  parts.solid = make_solid({std::move(closed), volume, {}}, 1);
  return parts;
}

MatterParts sheet_parts(const Body& body, TriangleMesh surface) {
  MatterParts parts;
  parts.sheets.push_back(make_sheet(std::move(surface), body, parts));
  return parts;
}

MatterParts strand_parts(double radius, std::vector<Vec3d> points, std::vector<std::array<int, 2>> segments) {
  MatterParts parts;
  parts.lines.push_back({std::move(points), std::move(segments), radius});
  return parts;
}

void check_size(const Body& body, double size) {
  if (size >= kShortest && size <= kLongest) return;
  throw SceneError({{body.domain_place,
                     fmt::format("the body is {:.3g} m across, and its volume or moments of inertia leave the range of "
                                 "double numbers; must be from {} to {} m across: check the file's unit and "
                                 "transform.scale",
                                 size, kShortest, kLongest)}});
}

void check_refinement(const FileDomain& file, std::size_t cells, int children) {
  constexpr double most = 1e7;
  const double made = static_cast<double>(cells) * std::pow(children, file.refine);
  if (made > most)
    throw SceneError({{file.refine_place, fmt::format("{} makes {:.3g} cells of {}; must leave at most {}", file.refine,
                                                      made, cells, most)}});
}

namespace {

Mat3d rotation_of(const Transform& t) {
  return t.angle != 0 ? rotation_about(normalized(t.axis), t.angle) : Mat3d::identity();
}

/// Where coordinates near a domain start, where it is far from the origin beside its size; else the origin.
Vec3d local_origin(const Bounds& bounds) {
  constexpr double far = 1000;  // sizes
  return norm(bounds.middle()) > far * bounds.diagonal() ? bounds.middle() : Vec3d{};
}

}  // namespace

Body near_origin(const Body& body) {
  Body result = body;
  Vec3d c;
  const auto shift = [&](std::initializer_list<Vec3d> corners, std::initializer_list<Vec3d*> places) {
    Bounds bounds;
    for (const Vec3d& x : corners) bounds.include(x);
    c = local_origin(bounds);
    for (Vec3d* place : places) *place -= c;
  };
  if (auto* box = std::get_if<BoxDomain>(&result.domain)) shift({box->min, box->max}, {&box->min, &box->max});
  if (auto* y = std::get_if<CylinderDomain>(&result.domain)) shift({y->from, y->to}, {&y->from, &y->to});
  if (auto* e = std::get_if<EllipsoidDomain>(&result.domain))
    shift({e->center - e->radii, e->center + e->radii}, {&e->center});
  if (auto* b = std::get_if<BlockDomain>(&result.domain)) {
    c = local_origin(bounds_of(b->corners));
    for (Vec3d& x : b->corners) x -= c;
  }
  if (auto* a = std::get_if<AnnulusDomain>(&result.domain)) {
    const Vec3d reach{{a->outer, a->outer, a->outer}};
    shift({a->center - reach, a->center + reach}, {&a->center});
  }
  if (auto* r = std::get_if<RectangleDomain>(&result.domain))
    shift({r->origin, r->origin + r->edge_u + r->edge_v}, {&r->origin});
  if (auto* l = std::get_if<LineDomain>(&result.domain)) shift({l->from, l->to}, {&l->from, &l->to});
  result.transform.translate += rotation_of(body.transform) * (c * body.transform.scale);
  return result;
}

MatterParts make_domain(const Body& body, std::vector<std::string>& messages) {
  MatterParts parts;
  const double scale = body.transform.scale;
  parts.rotation = rotation_of(body.transform);
  parts.translation = body.transform.translate;
  if (const auto* box = std::get_if<BoxDomain>(&body.domain)) parts.solid = make_box(*box, body);
  if (const auto* block = std::get_if<BlockDomain>(&body.domain)) parts.solid = make_block(*block, body);
  if (const auto* cylinder = std::get_if<CylinderDomain>(&body.domain)) parts.solid = make_cylinder(*cylinder, body);
  if (const auto* ellipsoid = std::get_if<EllipsoidDomain>(&body.domain))
    parts.solid = make_ellipsoid(*ellipsoid, scale);
  if (const auto* r = std::get_if<RectangleDomain>(&body.domain))
    parts.sheets.push_back(make_sheet(rectangle_mesh(*r, body, scale), body, parts));
  if (const auto* ring = std::get_if<AnnulusDomain>(&body.domain))
    parts.sheets.push_back(make_ring(*ring, body, parts));
  if (const auto* line = std::get_if<LineDomain>(&body.domain)) parts.lines.push_back(line_part(*line, body, scale));
  if (const auto* file = std::get_if<FileDomain>(&body.domain)) {
    Mesh mesh = read_for(file->place, file->path, file->read, MidNodes::drop);
    const Vec3d c = local_origin(bounds_of(mesh.points));
    for (Vec3d& x : mesh.points) x -= c;
    parts.translation += parts.rotation * (c * scale);
    add_mesh(mesh, body, parts, messages);
  }
  check_size(body, size_of(parts));
  return parts;
}

}  // namespace fascia
