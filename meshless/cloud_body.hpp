#pragma once

#include "meshless/body.hpp"
#include "meshless/frame_field.hpp"
#include "meshless/influences.hpp"
#include "meshless/scattered/kept_weights.hpp"

namespace fascia {

/// Where a rest position lies in a body.
struct Location {
  ScatteredPlace place;  ///< on the middle of a sheet or line
  Vec3d offset{};        ///< from there to the position [m]
  double distance = 0;   ///< from the body [m]
};

/// A body of frames that lie anywhere in matter of any dimension. All in world coordinates, at rest.
struct CloudSpec : BodyMatter {
  std::vector<CloudFrame> frames;   ///< its own
  std::vector<SharedFrame> shared;  ///< of other bodies; in the fields behind its own
  std::vector<CloudPoint> points;
  FrameField field;                            ///< weights
  std::shared_ptr<const KeptWeights> weights;  ///< of the points
  /// Weights of the points that are never negative, for the inertia; none: the others are so.
  std::shared_ptr<const KeptWeights> share;
  bool grid = false;   ///< frames of a regular grid, whose weights interpolate
  int through = 0;     ///< points through a sheet's thickness, 0: 2; 1 on sheets and lines: the 2014 paper's rule
  double spacing = 0;  ///< mean distance of frames [m]
  std::function<Location(const Vec3d&)> locate;
  TriangleMesh surface;  ///< carried along
  std::vector<std::array<int, 2>> segments;
};

class CloudBody final : public ModelBody {
 public:
  /// Appends frames to the model and points to the builder.
  /// @throws InputError  a point that too many frames reach, points that are too few, shared vertices without rotation
  ///                     where weights do not reproduce linear fields
  CloudBody(const CloudSpec& spec, Model& model, PointSetBuilder& points);

  bool interpolates() const override { return interpolates_; }
  Attachment attach(const Vec3d& X) const override;
  Attachment attach_point(std::size_t point) const override;
  std::vector<char> nodes_on_boundary() const override { return on_boundary_; }
  double distance(const Vec3d& X) const override { return locate_(X).distance; }
  std::string quality() const override { return quality_; }

 private:
  /// Of an integration point: the place that it stands at, and how far across the matter.
  struct PointPlace {
    std::size_t place = 0;  ///< index into places_
    Vec3d offset{};
    bool stabilized = true;  ///< false: too few of its frames turn
  };

  Attachment attach_place(const ScatteredPlace& place, const WeightsView& weights, const Vec3d& offset) const;
  Attachment attach_for_mechanics(std::size_t point) const;
  void split_points(const CloudSpec& spec);
  void number_frames(const CloudSpec& spec, Model& model);
  void check_still_nodes() const;
  void check_points(const CloudSpec& spec, const Model& model) const;
  static constexpr int kUnsorted = -1;
  void find_stabilized(const CloudSpec& spec, const Model& model);
  void add_points(const CloudSpec& spec, const Model& model, PointSetBuilder& points);
  /// Points of a group, and the frames of all of them together.
  struct Group {
    std::span<const std::size_t> members;
    std::size_t frames = 0;  ///< how many
  };
  void split_group(std::span<std::size_t> members, int sorted_along, std::vector<Group>& groups) const;
  void add_group(const CloudSpec& spec, std::span<const std::size_t> members, PointSetBuilder& points) const;
  void add_middle_ties(const CloudSpec& spec, PointSetBuilder& points) const;
  void add_inertia(const CloudSpec& spec, Model& model);
  void describe(const CloudSpec& spec);
  void warn_of_locking(const CloudSpec& spec);
  void warn_of_overlap(const CloudSpec& spec);
  int node_of(int frame) const {
    return frame < node_count_ ? first_node_ + frame : share_[static_cast<std::size_t>(frame - node_count_)].node;
  }
  bool follows_still(std::span<const int> frames) const;
  std::vector<int> nodes_at(const WeightsView& weights) const;

  FrameField field_;
  std::shared_ptr<const KeptWeights> weights_;  ///< by places_
  std::function<Location(const Vec3d&)> locate_;
  bool half_blend_, interpolates_;
  std::vector<Vec3d> frame_position_;  ///< own, then shared
  std::vector<SharedFrame> share_;
  std::vector<int> still_;  ///< model nodes that keep no rotation, ascending
  std::vector<char> on_boundary_;
  std::vector<ScatteredPlace> places_;
  std::vector<PointPlace> point_places_;  ///< of each integration point
  std::string quality_;
};

}  // namespace fascia
