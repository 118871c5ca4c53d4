#include "app/domains.hpp"

#include "core/geometry/inside.hpp"
#include "core/geometry/primitives.hpp"
#include "core/geometry/surface.hpp"
#include "core/math/rotation.hpp"
#include "io/mesh_reader.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace fascia::app {

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

SolidDomain make_box(const BoxDomain& b, double scale, const std::array<int, 3>& grid) {
  SolidDomain solid;
  solid.min = b.min * scale;
  solid.max = b.max * scale;
  const Vec3d size = solid.max - solid.min;
  solid.volume = size[0] * size[1] * size[2];
  solid.surface = box_surface(solid.min, solid.max, grid[0] - 1, grid[1] - 1, grid[2] - 1);
  return solid;
}

SolidDomain make_cylinder(const CylinderDomain& c, double scale, const std::array<int, 3>& grid) {
  SolidDomain solid;
  const Vec3d from = c.from * scale, to = c.to * scale;
  const double radius = c.radius * scale, length = norm(to - from);
  const Vec3d axis = normalized(to - from);
  solid.volume = kPi * radius * radius * length;
  solid.contains = [=](const Vec3d& x) {
    const double along = dot(x - from, axis);
    return along >= 0 && along <= length && norm(x - from - axis * along) <= radius;
  };
  const int most = std::clamp(*std::max_element(grid.begin(), grid.end()), 9, 200);
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

SolidDomain make_file(const FileDomain& f, double scale, std::vector<std::string>& messages) {
  ClosedSurface closed = closed_surface(io::read_mesh(f.path));
  SolidDomain solid;
  solid.volume = closed.volume * scale * scale * scale;
  solid.surface = std::move(closed.mesh);
  for (Vec3d& p : solid.surface.points) p *= scale;
  messages.insert(messages.end(), closed.messages.begin(), closed.messages.end());
  const auto test = std::make_shared<const InsideTest>(solid.surface);
  solid.contains = [test](const Vec3d& x) { return test->contains(x); };
  solid.distance = [test](const Vec3d& x) { return test->contains(x) ? 0.0 : test->distance(x); };
  set_bounds(solid);
  return solid;
}

}  // namespace

PlacedDomain make_domain(const Body& body) {
  PlacedDomain placed;
  const double scale = body.transform.scale;
  if (const auto* box = std::get_if<BoxDomain>(&body.domain)) placed.solid = make_box(*box, scale, body.grid);
  if (const auto* cylinder = std::get_if<CylinderDomain>(&body.domain))
    placed.solid = make_cylinder(*cylinder, scale, body.grid);
  if (const auto* ellipsoid = std::get_if<EllipsoidDomain>(&body.domain))
    placed.solid = make_ellipsoid(*ellipsoid, scale);
  if (const auto* file = std::get_if<FileDomain>(&body.domain)) placed.solid = make_file(*file, scale, placed.messages);
  if (body.transform.angle != 0)
    placed.rotation = rotation_about(normalized(body.transform.axis), body.transform.angle);
  placed.translation = body.transform.translate;
  return placed;
}

}  // namespace fascia::app
