#pragma once

#include "core/geometry/triangle_tree.hpp"
#include "core/physics/shell_triangle.hpp"
#include "shells/shell_mesh.hpp"
#include "shells/shell_stiffness.hpp"

#include <functional>

namespace fascia {

struct ShellBodySpec {
  ShellMesh mesh;
  double density = 0;                       ///< [kg/m³]
  std::vector<double> thickness;            ///< of each triangle [m]
  std::vector<PointMaterialSpec> material;  ///< of each triangle
  /// Stiffness of a triangle.
  std::function<ShellConstants<double>(const PlaneTriangle&, const ShellSection&)> stiffness = shell_stiffness;
};

/// A thin wall in a model: triangles on frames with six degrees of freedom, whose third axis is the wall's normal.
///
/// A third of a triangle's mass goes to each corner, with the rotary inertia of the fibre through the thickness,
/// m t²/12, and one of the drilling rotation as if the mass were spread over a disc of a small part of the triangle.
class ShellBody final : public ModelBody {
 public:
  /// Appends frames to the model and triangles to the builder.
  ShellBody(ShellBodySpec spec, Model& model, PointSetBuilder& points);

  std::string model_name() const override { return "shell"; }
  /// A place off the middle surface moves with the director: X = Y + ζ n, |ζ| at most half the thickness.
  Attachment attach(const Vec3d& X) const override;
  Attachment attach_point(std::size_t point) const override;
  Attachment attach_surface(std::size_t point) const override;
  std::vector<FacePoint> face_points() const override;
  /// At the place's height over the middle surface.
  PointTensors tensors_at(const Attachment& place, std::size_t nearest, const State& state) const override;
  Mat3d strain_at(const Attachment& place, const State& state) const override;
  std::vector<BodyField> own_fields(const State& state) const override;
  std::vector<char> nodes_on_boundary() const override;  ///< the rim
  double distance(const Vec3d& X) const override;
  std::string quality() const override { return quality_; }
  std::int64_t cell_number(int cell) const override {
    return mesh_.file_number.empty() ? cell : mesh_.file_number[static_cast<std::size_t>(cell)];
  }

  double thickness(std::size_t triangle) const { return thickness_[triangle]; }

 private:
  void store_tensors(const State& state, ThreadPool& pool, std::span<PointTensors> out) const override;
  /// Membrane strain (E₁₁, E₂₂, 2E₁₂) and curvature of a triangle at a state, and where its axes are.
  struct Strained {
    std::array<double, 3> membrane{}, curvature{};
    std::array<double, 3> acting_membrane{}, acting_curvature{};  ///< the same where stresses fade: strains that act
    std::array<double, 3> stretch{};                              ///< U₁₁, U₁₂, U₂₂
    Mat3d rest_axes, axes;
  };
  PlaneTriangle corners(std::size_t triangle) const;
  ShellSection section(std::size_t triangle) const;
  Attachment attachment(std::size_t triangle, const std::array<double, 3>& L, double offset) const;
  Strained strained(std::size_t triangle, const std::array<double, 3>& L, const State& state) const;
  ShellStrain<double> acting_strain(std::size_t triangle, const ShellStrain<double>& strain, const State& state) const;
  std::array<double, 3> membrane_stress(std::size_t triangle, const std::array<double, 3>& strain) const;
  Mat3d cauchy(std::size_t triangle, const Strained& s, double offset) const;
  BodyField node_means(const BodyField& cells) const;
  PointTensors tensors_of(std::size_t triangle, const Strained& s, double offset) const;
  void number_nodes(Model& model);
  double tilt(std::size_t triangle) const;
  void add_triangles(const ShellBodySpec& spec, PointSetBuilder& points);
  void add_mass(double density, Model& model);
  void describe();

  ShellMesh mesh_;
  std::vector<double> thickness_;
  std::vector<PointMaterialSpec> material_;
  std::vector<Mat3d> triangle_axes_;  ///< columns: in the plane, then the normal
  std::vector<double> area_;
  /// Corners of triangles at each node (3 · triangle + corner), and the angles there, while the body is built.
  std::vector<std::vector<int>> around_;
  std::vector<double> angle_;
  TriangleTree tree_;
  std::string quality_;
};

}  // namespace fascia
