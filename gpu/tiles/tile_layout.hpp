#pragma once

#include "core/base/thread_pool.hpp"
#include "gpu/tiles/tile_points.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace fascia {

/// Most influences of a point and most frames of a tile: their numbers fit into 5 and 8 bits.
inline constexpr int kMostTileInfluences = 32;
inline constexpr int kMostTileFrames = 255;

/// Where the lane stands in an entry of an incidence list, behind the influence's number.
inline constexpr int kTileLaneBits = 11;

/// A frame of a tile.
struct TileFrame {
  int frame = 0;   ///< running number, by first touching tile
  int slot = 0;    ///< of its partial sums
  int owner = 0;   ///< 1 in the one tile that adds what acts on the frame alone
  int writer = 0;  ///< 1 in the one tile of a device that writes the frame's vectors
};

/// Constants that all points of a tile share.
struct TileHead {
  double origin[3]{};  ///< places are relative to it [m]
  double blend = 1;    ///< c of TilePoints
};

/// Points cut into compact tiles of equal size, each computed by one block of threads from what it keeps on chip.
/// Arrays are (tiles × … × tile_size), so that neighbouring threads read neighbouring words; unused lanes and
/// influences are zero. Frames that no point touches belong to tiles without points.
struct TileLayout {
  int tile_size = 0;   ///< lanes of a tile
  int influences = 0;  ///< of each point, padded to a multiple of 4
  int tile_count = 0;
  int frame_count = 0;
  int most_frames = 0;  ///< of a tile
  bool drilling = false;
  std::vector<TileMaterial> materials;

  std::vector<int> frame_node;         ///< (frames) node of each
  std::vector<Vec3d> rest_position;    ///< (frames) [m]
  std::vector<int> frame_slot_begin;   ///< (frames + 1): partial sums of a frame stand side by side, by tile
  std::vector<int> slot_tile_frame;    ///< (slots) index into `tile_frames`
  std::vector<int> slot_tile;          ///< (slots)
  std::vector<int> tile_frame_begin;   ///< (tiles + 1)
  std::vector<TileFrame> tile_frames;  ///< in each tile those of most points first
  std::vector<TileHead> head;          ///< (tiles)

  std::vector<double> weights;            ///< (tiles × influences × 4 × lanes): w, g
  std::vector<double> places;             ///< (tiles × 4 × lanes): X − origin, volume
  std::vector<std::uint16_t> material;    ///< (tiles × lanes)
  std::vector<std::uint8_t> local;        ///< (tiles × influences × lanes): frame of the tile
  std::vector<std::uint16_t> list;        ///< (tiles × influences × lanes): influence << 11 | lane, frame by frame
  std::vector<std::uint16_t> list_begin;  ///< (tiles × list_stride()): where a frame's entries begin
  std::vector<int> source;                ///< (tiles × lanes) TilePoints::source, −1: unused

  int slot_count() const { return static_cast<int>(slot_tile.size()); }
  /// Frames of a tile and one, in whole 16 bytes.
  int list_stride() const { return (most_frames + 8) / 8 * 8; }
  std::size_t lanes() const { return at(tile_count) * at(tile_size); }
};

struct TileOptions {
  int tile_size = 256;    ///< lanes, a multiple of 16, at most 2048
  int most_frames = 255;  ///< of a tile
};

/// Cuts points by recursive coordinate bisection, numbers frames by first touching tile and orders influences and lists
/// so that neighbouring lanes read different banks of shared memory. None where a point has more than
/// kMostTileInfluences influences, or more than `most_frames`.
std::optional<TileLayout> make_tiles(const TilePoints& points, const TileOptions& options, ThreadPool& pool);

}  // namespace fascia
