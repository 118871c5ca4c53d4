#pragma once

#include "meshless/body.hpp"
#include "meshless/domain.hpp"
#include "meshless/influences.hpp"

#include <optional>

namespace fascia {

enum class GridWeightKind { trilinear, linear };
enum class IntegrationKind { automatic, full, selective };

/// A solid body on a regular grid of frames that spans the domain's bounding box.
struct GridSpec : BodyMatter {
  SolidDomain domain;
  std::array<int, 3> grid{2, 2, 2};            ///< frames along x, y, z
  std::optional<std::array<int, 3>> per_cell;  ///< Gauss points of a cell (trilinear weights)
  GridWeightKind weights = GridWeightKind::trilinear;
  IntegrationKind integration = IntegrationKind::automatic;
  Mat3d rotation = Mat3d::identity();  ///< rigid placement: X = rotation x + translation
  Vec3d translation{};
  std::vector<SharedFrame> shared;  ///< of other bodies: each stands for the frame of the grid at its place
};

class GridBody final : public ModelBody {
 public:
  /// Samples the domain, appends frames to the model and points to the builder.
  /// @throws InputError  a domain in which no point falls, volumes that cannot be formed, or a shared frame where the
  ///                     grid has none
  GridBody(const GridSpec& spec, Model& model, PointSetBuilder& points);

  bool selective() const override { return selective_; }
  Attachment attach(const Vec3d& X) const override;
  Attachment attach_point(std::size_t point) const override;
  Attachment attach_volumetric(const Attachment& at) const override;
  std::vector<char> nodes_on_boundary() const override;
  double distance(const Vec3d& X) const override;

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
  struct PointCell {
    int cell = -1;                     ///< whose frames move the point
    std::array<int, 3> tetrahedron{};  ///< linear weights: order of axes
  };
  struct CellShare {
    std::vector<int> grid_node;
    std::vector<double> w;
  };

  std::vector<Sample> sample(const GridSpec& spec) const;
  void find_owners(const GridSpec& spec, const std::vector<Sample>& samples, int full_count);
  void advise(const GridSpec& spec, int full_count);
  int nearest_owner(int cell) const;
  void number_frames(const GridSpec& spec, const std::vector<Sample>& samples, Model& model);
  void place_shared(const GridSpec& spec);
  void add_points(const GridSpec& spec, const std::vector<Sample>& samples, const Model& model,
                  PointSetBuilder& points);
  CellShare cell_share(const Sample& s) const;
  std::vector<double> frame_support(const std::vector<Sample>& samples) const;
  void add_inertia(const GridSpec& spec, const std::vector<Sample>& samples, Model& model);
  Attachment attach_local(const Vec3d& x, int cell, const std::array<int, 3>* tetrahedron) const;
  Vec3d cell_coordinates(const Vec3d& x, const Cell& cell) const;
  Vec3d to_local(const Vec3d& X) const { return transpose(rotation_) * (X - translation_); }
  Vec3d to_world(const Vec3d& x) const { return rotation_ * x + translation_; }
  int cell_at(const Vec3d& x) const;
  int grid_node(const std::array<int, 3>& cell, int corner) const;
  /// What stands for a frame of the grid; null: a frame of the body's own.
  const SharedFrame* share_at(int grid_node) const {
    const int k = share_of_grid_node_.empty() ? -1 : share_of_grid_node_[static_cast<std::size_t>(grid_node)];
    return k < 0 ? nullptr : &share_[static_cast<std::size_t>(k)];
  }
  Vec3d grid_position(int node) const;

  std::array<int, 3> grid_;
  Vec3d min_, spacing_;
  Mat3d rotation_;
  Vec3d translation_;
  GridWeightKind weights_;
  Mat3d halved_;  ///< Π of blended()
  bool selective_ = false;
  std::vector<Cell> cells_;
  std::vector<PointCell> point_cells_;
  std::vector<int> frame_of_grid_node_;  ///< node of the model, −1: dropped
  std::vector<SharedFrame> share_;
  std::vector<int> share_of_grid_node_;  ///< index into these, −1: none; empty where nothing is shared
  std::vector<int> still_;               ///< model nodes that keep no rotation, ascending
  std::function<double(const Vec3d&)> distance_;
};

}  // namespace fascia
