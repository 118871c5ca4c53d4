#pragma once

#include "meshless/scattered/point_grid.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace fascia {

/// The nearest of fixed points to each of many places that lie close together, as the voxels of a solid do: what can be
/// nearest to a place in a cubic block is listed once for all of them.
class BlockSearch {
 public:
  /// @param spacing  about the distance between points [m]
  BlockSearch(std::span<const Vec3d> points, double spacing);

  /// The nearest point, of equals (PointGrid) the first; −1 where there is none.
  int nearest(const Vec3d& x);

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& c) const {
      std::size_t sum = 0;
      for (const std::int64_t i : c) sum = (sum ^ static_cast<std::size_t>(i)) * 0x9E3779B97F4A7C15ULL;
      return sum ^ (sum >> 32);
    }
  };
  /// Its part of the candidates, a multiple of kLanes.
  struct Block {
    std::size_t begin = 0, end = 0;
  };
  static constexpr std::size_t kLanes = 8;  ///< distances that are computed together

  Block list(const Cell& cell);
  void add(int point, const Vec3d& x);

  std::span<const Vec3d> points_;
  PointGrid grid_;
  double edge_;  ///< of a block
  std::unordered_map<Cell, Block, CellHash> blocks_;
  std::array<std::vector<double>, 3> place_;  ///< of candidates, by axis
  std::vector<int> point_;                    ///< of candidates, ascending in each block
  Cell last_cell_{};
  Block last_{};
};

}  // namespace fascia
