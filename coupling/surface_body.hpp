#pragma once

#include "core/body/model_body.hpp"
#include "core/geometry/triangle_tree.hpp"

namespace fascia {

/// A surface without matter, whose vertices ride on other bodies (welded or embedded): for display, probes and loads.
class SurfaceBody final : public ModelBody {
 public:
  /// Appends a vertex for each point of the surface, in world coordinates.
  SurfaceBody(TriangleMesh surface, Model& model);

  std::string model_name() const override { return "surface"; }
  Attachment attach(const Vec3d& X) const override;
  Attachment attach_point(std::size_t point) const override { return attach_surface(point); }
  Attachment attach_surface(std::size_t point) const override;
  PointTensors tensors_at(const Attachment& /*place*/, std::size_t /*nearest*/, const State& /*state*/) const override {
    return {};
  }
  Mat3d strain_at(const Attachment& /*place*/, const State& /*state*/) const override { return {}; }
  std::vector<char> nodes_on_boundary() const override;  ///< the rim
  double distance(const Vec3d& X) const override;

 private:
  Attachment attachment(std::size_t triangle, const Vec3d& foot) const;
  TriangleTree tree_;
};

}  // namespace fascia
