#pragma once

#include "core/math/vec3.hpp"

#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace fascia {

/// Which frames are near a point. Results ascend by distance, equal ones (to kTie of point_grid.hpp) by index: they
/// depend neither on the search nor on rounding.
class FrameSearch {
 public:
  /// @param positions  copied
  explicit FrameSearch(std::span<const Vec3d> positions);
  ~FrameSearch();
  FrameSearch(FrameSearch&&) noexcept;
  FrameSearch& operator=(FrameSearch&&) noexcept;
  FrameSearch(const FrameSearch&) = delete;
  FrameSearch& operator=(const FrameSearch&) = delete;

  /// The k nearest; all where there are fewer.
  std::vector<int> nearest(const Vec3d& x, int k) const;
  /// Those at most `radius` away [m].
  std::vector<int> within(const Vec3d& x, double radius) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// How far apart the frames are around each of them [m]: mean distance to the 2 × dimension nearest others, kept
/// between half and twice the median of all. One frame alone has none: 0.
///
/// @param dimension  of the matter at each frame: 1, 2 or 3
/// @param first      frames that have a median of their own, apart from the others; 0: all have one
std::vector<double> local_spacing(std::span<const Vec3d> positions, std::span<const int> dimension,
                                  std::size_t first = 0);

/// Pairs i < j not farther apart than the tolerance [m], ascending.
std::vector<std::pair<int, int>> coincident(std::span<const Vec3d> positions, double tolerance);

}  // namespace fascia
