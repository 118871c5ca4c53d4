#pragma once

#include "core/body/model_body.hpp"
#include "core/geometry/triangle_tree.hpp"

#include <memory>
#include <optional>

namespace fascia {

class InsideTest;

/// A body that does not deform: bone, plate, instrument. All in world coordinates, at rest.
struct RigidBodySpec {
  TriangleMesh surface;           ///< that it carries; closed and outward where it has a volume
  bool closed = false;            ///< the surface encloses a volume
  std::optional<double> mass;     ///< [kg]
  std::optional<double> density;  ///< [kg/m³]; of closed surfaces
  /// About the mass centre, in world axes [kg m²]; default: of the volume or the surface.
  std::optional<Mat3d> inertia;
};

/// Volume, mass centre and second moment of what a surface encloses, or of the surface itself.
struct MassProperties {
  double measure = 0;  ///< [m³] or [m²]
  Vec3d center{};      ///< [m]
  Mat3d second{};      ///< Σ d dᵀ over the measure, d from the centre [m² measure]
};
MassProperties properties_of_volume(const TriangleMesh& closed);
MassProperties properties_of_area(const TriangleMesh& surface);

/// One frame at the mass centre, with true mass and inertia, that carries a surface.
class RigidBody final : public ModelBody {
 public:
  /// Appends the frame to the model.
  /// @throws InputError  a density of an open surface, a volume or mass that is not positive, an inertia that no mass
  ///                     has
  RigidBody(RigidBodySpec spec, Model& model, PointSetBuilder& points);

  std::string model_name() const override { return "rigid"; }
  Attachment attach(const Vec3d& X) const override;
  Attachment attach_point(std::size_t /*point*/) const override { return attach(center_); }
  PointTensors tensors_at(const Attachment& /*place*/, std::size_t /*nearest*/, const State& /*state*/) const override {
    return {};
  }
  Mat3d strain_at(const Attachment& /*place*/, const State& /*state*/) const override { return {}; }
  std::vector<char> nodes_on_boundary() const override { return {1}; }
  double distance(const Vec3d& X) const override;
  std::string quality() const override;

 private:
  Vec3d center_{};
  TriangleTree tree_;
  std::shared_ptr<const InsideTest> inside_;  ///< of closed surfaces
};

}  // namespace fascia
