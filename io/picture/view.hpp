#pragma once

#include "core/math/vec3.hpp"

#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <optional>

namespace fascia::io {

/// How one looks at bodies: unit vectors to the right, upwards and towards the eye.
struct View {
  Vec3d right{{1, 0, 0}}, up{{0, 1, 0}}, toward{{0, 0, 1}};

  Vec3d of(const Vec3d& x) const { return {{dot(right, x), dot(up, x), dot(toward, x)}}; }
};

/// @param direction  from the bodies towards the eye, not zero
/// @param up  points upwards in the picture; without it, or where one looks along it: y where one looks within 45° of
///            the z axis, z otherwise
View view_along(const Vec3d& direction, const std::optional<Vec3d>& up);

/// A box in the view's directions.
struct Extent {
  Vec3d low{{1, 1, 1}}, high{{-1, -1, -1}};  ///< empty: low > high

  bool empty() const { return low[0] > high[0]; }
  Vec3d size() const { return empty() ? Vec3d{} : high - low; }
  void add(const Vec3d& x);
  void add(const Extent& other);
};

Extent extent_of(vtkPoints* points, const View& view);
Extent extent_of(vtkPolyData* part, const View& view);

/// Where a picture shows a place x: view.of(x − centre) / length, so that bodies of every size and place are drawn with
/// numbers near one.
struct Placing {
  View view;
  Vec3d center{};     ///< in the view's directions [m]
  double length = 1;  ///< [m]

  Vec3d of(const Vec3d& x) const { return (view.of(x) - center) * (1 / length); }
  /// The part at its places; points are new, all else is shared.
  vtkSmartPointer<vtkPolyData> of(vtkPolyData* part) const;
};

}  // namespace fascia::io
