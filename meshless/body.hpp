#pragma once

#include "core/geometry/mesh.hpp"
#include "core/model/model.hpp"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fascia {

/// A solid in the axes of its frame grid, before its rigid placement.
struct SolidDomain {
  Vec3d min{}, max{};                            ///< bounding box [m]
  double volume = 0;                             ///< [m³]
  std::function<bool(const Vec3d&)> contains;    ///< empty: the whole box
  std::function<double(const Vec3d&)> distance;  ///< from a point to the solid [m], 0 inside; empty: the box
  TriangleMesh surface;                          ///< closed, outward; carried along for pictures and surface loads
};

/// Material of a point.
struct PointMaterialSpec {
  double lambda = 0, mu = 0;                       ///< [Pa]
  double mass_damping = 0, stiffness_damping = 0;  ///< [1/s], [s]
};

enum class GridWeightKind { trilinear, linear };
enum class IntegrationKind { automatic, full, selective };

/// A meshless body on a regular grid of frames that spans the domain's bounding box.
struct MeshlessSpec {
  SolidDomain domain;
  std::array<int, 3> grid{2, 2, 2};            ///< frames along x, y, z
  std::optional<std::array<int, 3>> per_cell;  ///< Gauss points of a cell (trilinear weights)
  GridWeightKind weights = GridWeightKind::trilinear;
  bool half_blend = true;  ///< the paper's rule otherwise
  double drilling = 0.1;   ///< γ/μ
  IntegrationKind integration = IntegrationKind::automatic;
  double density = 0;                  ///< [kg/m³]
  Mat3d rotation = Mat3d::identity();  ///< rigid placement: X = rotation x + translation
  Vec3d translation{};
  std::function<PointMaterialSpec(const Vec3d&)> material;  ///< by rest position
};

/// Where a material point is attached: the frames that move it.
struct Attachment {
  std::vector<int> nodes;  ///< of the model
  std::vector<Influence> influences;
  int cell = -1;
};

/// A point with what it weighs, for results.
struct BodyPoint {
  Vec3d X{};          ///< [m]
  double volume = 0;  ///< [m³]
  double lambda = 0, mu = 0;
  int cell = -1;                     ///< whose frames move it
  std::array<int, 3> tetrahedron{};  ///< linear weights: order of axes
};

/// A meshless body in a model. Its frames are a contiguous range, its groups of points too.
class MeshlessBody {
 public:
  /// Samples the domain, appends frames to the model and points to the builder.
  /// @throws InputError  a domain in which no point falls, or volumes that cannot be formed
  MeshlessBody(const MeshlessSpec& spec, Model& model, PointSetBuilder& points);

  int first_frame() const { return first_frame_; }
  int frame_count() const { return frame_count_; }
  const std::vector<BodyPoint>& points() const { return points_; }
  bool selective() const { return selective_; }
  double volume() const { return volume_; }
  double mass() const { return mass_; }
  double size() const { return size_; }                     ///< diagonal of the bounding box [m]
  const TriangleMesh& surface() const { return surface_; }  ///< at rest, placed
  const std::vector<std::string>& messages() const { return messages_; }
  int first_group = 0, group_count = 0;  ///< in the model's point set; set by who closes the set

  /// The frames that move the material at a rest position.
  Attachment attach(const Vec3d& X) const;
  /// The same for an integration point, exactly as the mechanics see it.
  Attachment attach(const BodyPoint& point) const;
  /// The same at the point whose volumetric strain stands for X's cell (selective integration).
  Attachment attach_volumetric(const Attachment& at) const;
  /// Frames that touch a cell without points, or the outside: 1 (one entry a frame of the body).
  std::vector<char> frames_on_boundary() const;
  /// Distance from X to the body [m]; 0 inside.
  double distance(const Vec3d& X) const;

 private:
  struct Cell {
    std::array<int, 3> index{};
    int owner = -1;  ///< the cell whose frames move its points
    int point_count = 0;
    Vec3d center{};     ///< of its points, in grid axes
    bool whole = true;  ///< linear weights: each of its tetrahedra has points
  };
  struct Sample {
    Vec3d x{};  ///< grid axes
    double volume = 0;
    int cell = 0;
    std::array<int, 3> tetrahedron{};  ///< linear weights: order of axes
  };

  struct CellShare {
    std::vector<int> frame;
    std::vector<double> w;
  };

  std::vector<Sample> sample(const MeshlessSpec& spec) const;
  void find_owners(const std::vector<Sample>& samples, int full_count);
  int nearest_owner(int cell) const;
  void number_frames(const std::vector<Sample>& samples, Model& model);
  void add_points(const MeshlessSpec& spec, const std::vector<Sample>& samples, PointSetBuilder& points);
  CellShare cell_share(const Sample& s) const;
  std::vector<double> frame_support(const std::vector<Sample>& samples) const;
  void add_inertia(const MeshlessSpec& spec, const std::vector<Sample>& samples, Model& model);
  Attachment attach_local(const Vec3d& x, int cell, const std::array<int, 3>* tetrahedron) const;
  Vec3d cell_coordinates(const Vec3d& x, const Cell& cell) const;
  Vec3d to_local(const Vec3d& X) const { return transpose(rotation_) * (X - translation_); }
  Vec3d to_world(const Vec3d& x) const { return rotation_ * x + translation_; }
  int cell_at(const Vec3d& x) const;
  int grid_node(const std::array<int, 3>& cell, int corner) const;
  Vec3d grid_position(int node) const;

  std::array<int, 3> grid_;
  Vec3d min_, spacing_;
  Mat3d rotation_;
  Vec3d translation_;
  GridWeightKind weights_;
  double blend_factor_;
  bool selective_ = false;
  double volume_ = 0, mass_ = 0, size_ = 0;
  int first_frame_ = 0, frame_count_ = 0;
  std::vector<Cell> cells_;
  std::vector<int> frame_of_grid_node_;  ///< −1: dropped
  std::vector<BodyPoint> points_;
  TriangleMesh surface_;
  std::function<double(const Vec3d&)> distance_;
  std::vector<std::string> messages_;
};

}  // namespace fascia
