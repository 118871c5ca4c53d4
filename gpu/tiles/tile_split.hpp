#pragma once

#include "core/solver/settings.hpp"
#include "gpu/tiles/tile_layout.hpp"

#include <vector>

namespace fascia {

inline constexpr int kMostShares = kMostDevices;

/// Where a share's row of numbers goes in another share.
struct TileExport {
  int row = 0;
  int share = 0;
  int remote_row = 0;
};

/// Share of one of several devices: tiles that stand side by side, with all frames that they touch. Vectors of frames
/// of several shares are updated in each of them from the same sums in the same order, so that all copies agree bit for
/// bit; only partial sums travel.
struct TileShare {
  /// Frames that the share owns stand before those that it shares without owning them. A frame's slots are those of
  /// all tiles in their order, with slot_tile −1 where another share has the tile.
  TileLayout layout;
  int owned = 0;                     ///< frames; each belongs to one share
  std::vector<TileExport> partials;  ///< slots of this share's tiles that others sum as well

  std::vector<int> shared;              ///< frames of several shares, ascending
  std::vector<int> shared_block_begin;  ///< (shared + 1) rows for the own blocks of a frame, by share
  std::vector<int> own_block;           ///< (shared) this share's among them
  std::vector<TileExport> blocks;       ///< own blocks that others sum as well
};

/// Shares of as many tiles, one beside another. @param shares  at most as many as there are tiles, and kMostShares
std::vector<TileShare> split_tiles(const TileLayout& tiles, int shares);

/// A layout that is not split.
TileShare whole_share(TileLayout tiles);

}  // namespace fascia
