#pragma once

#include "core/geometry/mesh.hpp"

/// Closed, outward-oriented surfaces of simple solids. All counts must be at least 1 (3 around a cylinder).
namespace fascia {

/// A box whose faces have nx, ny, nz cells along the axes, two triangles each. `min` must be below `max`.
TriangleMesh box_surface(const Vec3d& min, const Vec3d& max, int nx, int ny, int nz);

/// A cylinder with flat caps; vertices lie on the circle. `from` and `to` must differ.
TriangleMesh cylinder_surface(const Vec3d& from, const Vec3d& to, double radius, int n_around, int n_along);

/// An ellipsoid along the axes: an octahedron with n edges from pole to pole of each axis, its vertices on the
/// ellipsoid (the six ends of the axes among them).
TriangleMesh ellipsoid_surface(const Vec3d& center, const Vec3d& radii, int n);

}  // namespace fascia
