#pragma once

#include "core/base/thread_pool.hpp"
#include "core/math/vec3.hpp"
#include "meshless/scattered/raw_array.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace fascia {

/// The nearest of some points to each of many places, as the voxels of a solid are, for points that move from call to
/// call. Places are sorted into cubic blocks; what can be nearest in a block is listed once for all of them.
class BlockSearch {
 public:
  /// @param spacing  about the distance between points [m]
  /// @param asked    at how many offsets from each place nearest() is to ask
  BlockSearch(std::span<const Vec3d> places, double spacing, ThreadPool& pool, double asked = 1);

  /// Finds the nearest point to each place, as many as there are places, of equals (kTie of point_grid.hpp) the first;
  /// −1 where there is none. The same for any number of threads.
  ///
  /// @param around  offsets from each place at which that is asked; results are by place, then by offset
  void nearest(std::span<const Vec3d> points, std::span<int> nearest, ThreadPool& pool,
               std::span<const Vec3d> around = kAtPlaces) const;

 private:
  using Cell = std::array<int, 3>;
  static constexpr std::size_t kLanes = 8;  ///< fills the batches of any processor
  static constexpr std::array<Vec3d, 1> kAtPlaces{};

  /// Cells of one size that cover all places.
  struct Cells {
    Vec3d low{};
    double edge = 0;  ///< [m]
    Cell count{1, 1, 1};

    /// @param width  wanted; it grows until there are at most so many cells
    Cells(const Vec3d& min, const Vec3d& max, double width, double most);
    /// The cell that holds a place; the outermost one in the direction of a place outside.
    Cell of(const Vec3d& x) const;
    std::size_t number(const Cell& c) const;
    std::size_t size() const;
    Vec3d middle(std::size_t number) const;
  };
  /// Points by cell. There are some times as many cells as points at most: where the places of a flat body are much
  /// closer to one another than the points, most cells would be empty, and looking through them would take for ever.
  struct Sorted {
    Cells cells;
    std::vector<int> begin, index;  ///< of each cell in the arrays, and of each point in the caller's order
    std::vector<Vec3d> x;
  };
  /// Points that can be nearest in a block, and their indices, as numbers that stand beside distances.
  struct Candidates {
    std::array<std::vector<double>, 3> x;
    std::vector<double> index;
    std::size_t count = 0;

    void make_room(std::size_t more) {
      if (count + more <= index.size()) return;
      index.resize(2 * (count + more));
      for (std::vector<double>& along : x) along.resize(index.size());
    }
  };

  Sorted sorted(std::span<const Vec3d> points) const;
  /// @param half  distance of the block's faces from its middle [m]
  double reach_of(const Vec3d& middle, double half, const Sorted& points) const;
  void list(const Vec3d& middle, double half, const Sorted& points, Candidates& out) const;
  void search(std::size_t first, std::size_t last, const Candidates& among, std::span<const Vec3d> around,
              std::span<int> nearest) const;

  Cells blocks_;      ///< of places
  Vec3d low_, high_;  ///< of all places
  double spacing_;
  std::vector<std::size_t> begin_;  ///< of each block in the arrays of places, multiples of kLanes
  std::array<RawArray<double>, 3> x_;
  RawArray<int> place_;  ///< in the caller's order; −1: fills up the lanes
};

}  // namespace fascia
