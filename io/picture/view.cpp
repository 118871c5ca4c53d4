#include "io/picture/view.hpp"

#include <vtkNew.h>

#include <algorithm>
#include <cmath>

namespace fascia::io {
namespace {

/// The vector gets length 1, however small or large it is; zero stays zero.
Vec3d direction_of(const Vec3d& v) {
  const double largest = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  if (!(largest > 0)) return {};
  return normalized(Vec3d{{v[0] / largest, v[1] / largest, v[2] / largest}});
}

}  // namespace

View view_along(const Vec3d& direction, const std::optional<Vec3d>& up) {
  constexpr double smallest_sine = 0.02;
  View view;
  view.toward = direction_of(direction);
  Vec3d upright = up ? direction_of(*up) : Vec3d{};
  if (norm(cross(upright, view.toward)) < smallest_sine) {
    const bool along_z = std::abs(view.toward[2]) > std::sqrt(0.5);
    upright = along_z ? Vec3d{{0, 1, 0}} : Vec3d{{0, 0, 1}};
  }
  view.right = normalized(cross(upright, view.toward));
  view.up = cross(view.toward, view.right);
  return view;
}

void Extent::add(const Vec3d& x) {
  if (empty()) low = high = x;
  for (int c = 0; c < 3; ++c) {
    low[c] = std::min(low[c], x[c]);
    high[c] = std::max(high[c], x[c]);
  }
}

void Extent::add(const Extent& other) {
  if (other.empty()) return;
  add(other.low);
  add(other.high);
}

Extent extent_of(vtkPoints* points, const View& view) {
  Extent extent;
  for (vtkIdType p = 0; points && p < points->GetNumberOfPoints(); ++p) {
    Vec3d x;
    points->GetPoint(p, x.v);
    extent.add(view.of(x));
  }
  return extent;
}

Extent extent_of(vtkPolyData* part, const View& view) { return extent_of(part->GetPoints(), view); }

vtkSmartPointer<vtkPolyData> Placing::of(vtkPolyData* part) const {
  auto placed = vtkSmartPointer<vtkPolyData>::New();
  placed->ShallowCopy(part);
  vtkNew<vtkPoints> points;
  for (vtkIdType p = 0; p < part->GetNumberOfPoints(); ++p) {
    Vec3d x;
    part->GetPoint(p, x.v);
    points->InsertNextPoint(of(x).v);
  }
  placed->SetPoints(points);
  return placed;
}

}  // namespace fascia::io
