#pragma once

#include "gpu/tiles/tile_points.hpp"

namespace fascia {

struct TileRange {
  std::size_t begin = 0, end = 0;
};

/// Points in an order in which tiles are ranges.
struct TileCut {
  std::vector<int> order;
  std::vector<TileRange> ranges;  ///< at most `tile_size` points and `most_frames` frames each
};

/// Recursive coordinate bisection across the longest side, both halves whole tiles; inside tiles on to eight points.
/// Points of different blend factors are in different tiles.
TileCut cut_points(const TilePoints& points, int tile_size, int most_frames);

}  // namespace fascia
