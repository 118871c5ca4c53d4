#pragma once

#include "core/geometry/mesh.hpp"
#include "core/model/model.hpp"
#include "core/physics/point_law.hpp"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace fascia {

/// Material of a point.
struct PointMaterialSpec {
  double lambda = 0, mu = 0;                       ///< [Pa]
  double mass_damping = 0, stiffness_damping = 0;  ///< [1/s], [s]
};

/// What a body is made of and how it is discretised, whatever its frames.
struct BodyMatter {
  bool affine = false;                                      ///< frames of 12 degrees of freedom
  bool half_blend = true;                                   ///< the paper's rule otherwise
  double stabilization = 0.1;                               ///< γ/μ
  double density = 0;                                       ///< [kg/m³]
  std::function<PointMaterialSpec(const Vec3d&)> material;  ///< by rest position
};

/// Where a material point is attached: the frames that move it.
struct Attachment {
  std::vector<int> nodes;  ///< of the model, ascending
  std::vector<Influence> influences;
  int cell = -1;  ///< of a frame grid
};

/// An integration point with what it weighs, for results.
struct BodyPoint {
  Vec3d X{};          ///< [m]
  double volume = 0;  ///< [m³]
  double lambda = 0, mu = 0;
  Vec3d middle{};  ///< its place on the middle of a sheet or line; X in a solid [m]
  Law law = Law::solid;
  Mat3d axes = Mat3d::identity();  ///< of a thin law: columns, tangents first
  bool transverse = false;         ///< as in PointRule
};

/// Lever and gradient of a frame with weight w and gradient g: half of its rotation acts along the directions in which
/// the weights reproduce linear fields (docs/notation.md).
/// @param halved  projector Π on these directions; 0: the paper's rule
/// @param d       place on the matter's middle minus frame, at rest
/// @param offset  material point minus that place, across the matter
inline Influence blended(double w, const Vec3d& g, const Mat3d& halved, const Vec3d& d, const Vec3d& offset = {}) {
  const Mat3d M = Mat3d::identity() - halved * 0.5;
  const Vec3d lever = M * d + offset;
  return {w, g, lever * w, outer(lever, g) + M * w};
}

/// A meshless body in a model. Its frames are a contiguous range, its groups of points too.
class MeshlessBody {
 public:
  virtual ~MeshlessBody() = default;

  int first_frame() const { return first_frame_; }
  int frame_count() const { return frame_count_; }
  const std::vector<BodyPoint>& points() const { return points_; }
  double volume() const { return volume_; }
  double mass() const { return mass_; }
  double size() const { return size_; }                     ///< diagonal of the bounding box [m]
  const TriangleMesh& surface() const { return surface_; }  ///< at rest; of a sheet its middle
  /// Pairs of points of the surface mesh that a line runs between.
  const std::vector<std::array<int, 2>>& segments() const { return segments_; }
  const std::vector<std::string>& messages() const { return messages_; }
  int first_group = 0, group_count = 0;  ///< in the model's point set; set by who closes the set

  /// λ is integrated at one point a cell.
  virtual bool selective() const { return false; }
  /// A frame's weight is 1 at its own place: holding the frames holds the material there.
  virtual bool interpolates() const { return true; }
  /// The frames that move the material at a rest position.
  virtual Attachment attach(const Vec3d& X) const = 0;
  /// The same for an integration point, exactly as the mechanics see it.
  virtual Attachment attach_point(std::size_t point) const = 0;
  /// The same at the point whose volumetric strain stands for X's cell (selective integration).
  virtual Attachment attach_volumetric(const Attachment& at) const { return at; }
  /// Frames on the outside: 1 (one entry a frame of the body).
  virtual std::vector<char> frames_on_boundary() const = 0;
  /// Distance from X to the body [m]; 0 inside.
  virtual double distance(const Vec3d& X) const = 0;
  /// One line on how the weights do in this body; empty where there is nothing to say.
  virtual std::string quality() const { return ""; }

 protected:
  MeshlessBody() = default;
  MeshlessBody(const MeshlessBody&) = default;
  MeshlessBody(MeshlessBody&&) = default;
  MeshlessBody& operator=(const MeshlessBody&) = default;
  MeshlessBody& operator=(MeshlessBody&&) = default;

  double volume_ = 0, mass_ = 0, size_ = 0;
  int first_frame_ = 0, frame_count_ = 0;
  std::vector<BodyPoint> points_;
  TriangleMesh surface_;
  std::vector<std::array<int, 2>> segments_;
  std::vector<std::string> messages_;
};

}  // namespace fascia
