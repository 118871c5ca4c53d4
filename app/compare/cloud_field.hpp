#pragma once

#include "app/compare/local_fit.hpp"
#include "app/compare/rest_field.hpp"
#include "core/geometry/inside.hpp"

#include <optional>

namespace fascia::app {

/// Places of quadrature of triangles and lines, with stencils of their corners.
/// @param flat  number of triangles; those behind are lines, with their second end twice
std::vector<Sample> surface_samples(const TriangleMesh& surface, std::size_t flat);

/// Points of a meshless body's .vtu that are integration points. Frames are none: they need not lie in the body.
std::vector<int> integration_points(const io::VisualMesh& mesh);

/// The fields of a meshless body: interpolated between its integration points and those of its surface.
class CloudField final : public RestField {
 public:
  /// @param surface  triangles of the surface or sheet, then its lines, on all points of the .vtu at rest
  /// @param flat  number of triangles among them
  CloudField(TriangleMesh surface, std::size_t flat, std::vector<int> integration_points, double volume);

  int dimension() const override;
  Stencil stencil_at(const Vec3d& X) const override;
  /// A solid is sampled at Gauss points of a grid around it, those that lie in it: about four for each of its points,
  /// from 2,000 to 40,000.
  std::vector<Sample> samples() const override;
  std::vector<Stencil> checks() const override;
  bool has_cells() const override { return false; }
  std::size_t resolution() const override { return points_.size(); }

 private:
  Stencil fitted(const Vec3d& X, int except = -1) const;
  std::vector<Sample> solid_samples() const;

  TriangleMesh surface_;
  std::size_t flat_;
  std::vector<int> points_, integration_points_;  ///< of the .vtu: all that carry values of the matter; some of them
  LocalFit fit_;                                  ///< of points_
  TriangleTree tree_;
  std::optional<InsideTest> solid_;
};

}  // namespace fascia::app
