#pragma once

#include "meshless/scattered/kept_weights.hpp"
#include "meshless/scattered/neighbours.hpp"
#include "meshless/scattered/scattered_weights.hpp"

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace fascia {

/// Weights of a body's frames (numbered from 0) at a place.
using FrameField = std::function<ScatteredWeights(const ScatteredPlace&)>;

enum class ScatteredKind { mls, shepard, wendland, cubic_spline };

/// A frame of a cloud.
struct CloudFrame {
  Vec3d x{};  ///< [m]
  Mat3d orientation = Mat3d::identity();
  int dimension = 3;         ///< of the matter there
  Vec3d normal{};            ///< of a sheet
  bool on_boundary = false;  ///< of the matter
};

/// A place where matter is integrated: on a sheet or line it stands for the points through the thickness or across the
/// section.
struct CloudPoint {
  ScatteredPlace place;
  double volume = 0;  ///< [m³]
  double extent = 0;  ///< thickness of a sheet, radius of a line [m]
};

/// Which frames a place follows.
struct Reach {
  std::vector<double> support;  ///< of each frame [m]
  int neighbours = 0;           ///< above 0: the nearest ones, whatever the supports
  int most = 0;                 ///< above 0: no more than these, the deepest in their supports
};

/// Weights of scattered frames. Frames on the opposite wall of a sheet do not count.
FrameField scattered_field(ScatteredKind kind, std::vector<CloudFrame> frames, Reach reach);

/// A parallelogram (two directions) or a segment (one) with frames at the nodes of a regular grid.
struct ThinGrid {
  Vec3d origin{};
  std::vector<Vec3d> edge;  ///< whole length of each direction [m]
  std::vector<int> count;   ///< frames along each

  Vec3d position(int node) const;
  int node_count() const;
};

/// Bilinear or linear weights on a thin grid. Frame numbers run along the first direction first.
FrameField thin_grid_field(const ThinGrid& grid);

/// A field's weights at the places of points, found by all threads.
std::shared_ptr<const KeptWeights> weights_of(const FrameField& field, std::span<const CloudPoint> points,
                                              ThreadPool& pool);

/// The same weights with other numbers of the frames. @param number  by the old one, distinct
FrameField renumbered_field(FrameField field, std::vector<int> number);

}  // namespace fascia
