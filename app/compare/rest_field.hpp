#pragma once

#include "core/math/vec3.hpp"
#include "io/result_writer.hpp"

#include <memory>
#include <vector>

namespace fascia::app {

/// Points of a .vtu whose values, weighted, give its fields at a place.
struct Stencil {
  std::vector<int> points;
  std::vector<double> weights;
  double distance = 0;  ///< from the place that was asked for to the body, which the fields are then taken at [m]

  void add(int point, double weight) {
    points.push_back(point);
    weights.push_back(weight);
  }
};

/// A place of a body.
struct Sample {
  Vec3d X{};
  double weight = 0;  ///< volume, area or length that it stands for [m³, m², m]; 0 of points of the mesh
  Stencil stencil;
};

/// The point fields of a body's .vtu as functions of the rest position.
class RestField {
 public:
  virtual ~RestField() = default;
  RestField(const RestField&) = delete;
  RestField& operator=(const RestField&) = delete;

  /// Dimension of the matter: 3, 2 of a surface, 1 of lines, 0 of points alone.
  virtual int dimension() const = 0;
  /// The fields' stencil at X or, where X is not in the body, at the place of it that is nearest.
  virtual Stencil stencil_at(const Vec3d& X) const = 0;
  /// Places of quadrature, whose weights add up to the body's volume, area or length, then the points of the mesh.
  virtual std::vector<Sample> samples() const = 0;
  /// Where cells do not say what the fields are between points: stencils of the interpolation's error at some of the
  /// points, each from its neighbours alone. Empty where cells do.
  virtual std::vector<Stencil> checks() const { return {}; }
  /// Says whether cells do.
  virtual bool has_cells() const { return true; }
  /// Number of cells, or of points where there are none.
  virtual std::size_t resolution() const = 0;

  double size() const { return size_; }  ///< diagonal of the bounding box [m]

 protected:
  explicit RestField(const std::vector<Vec3d>& rest);

  std::vector<Vec3d> rest_;  ///< of the points of the .vtu [m]
  double size_;
};

/// Rest positions of the points of a .vtu [m]. @throws InputError  where it does not hold them
std::vector<Vec3d> rest_positions(const io::VisualMesh& mesh);

/// Elements have their shape functions, shells and surfaces the linear functions of their triangles. A meshless body
/// has no cells: its fields are interpolated (LocalFit) between its integration points and those of its surface.
/// @param volume  of the matter, as summary.json says it; tells a closed sheet from a solid [m³]
std::unique_ptr<RestField> rest_field(const io::VisualMesh& mesh, double volume);

}  // namespace fascia::app
