#include "gpu/tiles/tile_layout.hpp"

#include "gpu/tiles/tile_cut.hpp"
#include "gpu/tiles/tile_order.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace fascia {

namespace {

/// Frames in the order of their first tile and point; those that no point touches behind them.
/// @returns  by node
std::vector<int> number_frames(const TilePoints& points, const TileCut& cut, TileLayout& out) {
  std::vector<int> frame_of_node(at(points.node_count()), -1);
  const auto take = [&](int node) {
    if (frame_of_node[at(node)] >= 0) return;
    frame_of_node[at(node)] = static_cast<int>(out.frame_node.size());
    out.frame_node.push_back(node);
    out.rest_position.push_back(points.rest_position[at(node)]);
  };
  for (const int q : cut.order)
    for (std::size_t k = points.begin[at(q)]; k < points.begin[at(q) + 1]; ++k) take(points.node[k]);
  for (int node = 0; node < points.node_count(); ++node) take(node);
  out.frame_count = points.node_count();
  return frame_of_node;
}

/// Each number once, the most frequent first.
void sort_by_count(std::vector<int>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  std::vector<std::pair<int, int>> counted;  // minus how often, number
  for (const int n : numbers) {
    if (counted.empty() || counted.back().second != n) counted.emplace_back(0, n);
    --counted.back().first;
  }
  std::sort(counted.begin(), counted.end());
  numbers.clear();
  for (const auto& [count, n] : counted) numbers.push_back(n);
}

/// Frames of each tile, those of most points first, so that threads that sum side by side have as much to do; tiles
/// without points take the frames that no point touches.
std::vector<std::vector<int>> collect_frames(const TilePoints& points, const TileCut& cut,
                                             const std::vector<int>& frame_of_node, int most_frames, ThreadPool& pool) {
  std::vector<std::vector<int>> frames(cut.ranges.size());
  pool.for_ranges(static_cast<int>(cut.ranges.size()), 64, [&](int begin, int end) {
    for (int t = begin; t < end; ++t) {
      std::vector<int>& own = frames[at(t)];
      for (std::size_t i = cut.ranges[at(t)].begin; i < cut.ranges[at(t)].end; ++i)
        for (std::size_t k = points.begin[at(cut.order[i])]; k < points.begin[at(cut.order[i]) + 1]; ++k)
          own.push_back(frame_of_node[at(points.node[k])]);
      sort_by_count(own);
    }
  });
  int touched = 0;
  for (const std::vector<int>& own : frames)
    for (const int f : own) touched = std::max(touched, f + 1);
  for (int first = touched; first < points.node_count(); first += most_frames) {
    frames.emplace_back(at(std::min(most_frames, points.node_count() - first)));
    std::iota(frames.back().begin(), frames.back().end(), first);
  }
  return frames;
}

/// The first tile that touches a frame owns it; partial sums of a frame stand side by side in the order of tiles.
void place_partials(const std::vector<std::vector<int>>& frames, TileLayout& out) {
  out.frame_slot_begin.assign(at(out.frame_count) + 1, 0);
  out.tile_frame_begin.assign(1, 0);
  for (const std::vector<int>& own : frames) {
    out.most_frames = std::max(out.most_frames, static_cast<int>(own.size()));
    out.tile_frame_begin.push_back(out.tile_frame_begin.back() + static_cast<int>(own.size()));
    for (const int f : own) ++out.frame_slot_begin[at(f) + 1];
  }
  for (int f = 0; f < out.frame_count; ++f) out.frame_slot_begin[at(f) + 1] += out.frame_slot_begin[at(f)];
  std::vector<int> next(out.frame_slot_begin.begin(), out.frame_slot_begin.end() - 1);
  out.tile_frames.reserve(at(out.tile_frame_begin.back()));
  out.slot_tile.resize(at(out.tile_frame_begin.back()));
  out.slot_tile_frame.resize(at(out.tile_frame_begin.back()));
  for (std::size_t t = 0; t < frames.size(); ++t) {
    for (const int f : frames[t]) {
      const int slot = next[at(f)]++;
      out.slot_tile[at(slot)] = static_cast<int>(t);
      out.slot_tile_frame[at(slot)] = static_cast<int>(out.tile_frames.size());
      const int first = slot == out.frame_slot_begin[at(f)] ? 1 : 0;
      out.tile_frames.push_back({f, slot, first, first});
    }
  }
}

class TileFiller {
 public:
  TileFiller(const TilePoints& points, const TileCut& cut, const std::vector<int>& frame_of_node, TileLayout& out)
      : points_(points), cut_(cut), frame_of_node_(frame_of_node), out_(out) {}

  void fill(int tile) {
    const std::size_t P = at(out_.tile_size), K = at(out_.influences);
    const TileRange range = at(tile) < cut_.ranges.size() ? cut_.ranges[at(tile)] : TileRange{};
    set_head(tile, range);
    index_frames(tile);
    frames_.assign(P * K, 0);
    number_.assign(P * K, -1);
    for (std::size_t lane = 0; lane < range.end - range.begin; ++lane) gather_influences(range, lane);
    spread_influences(frames_, number_, out_.tile_size, out_.influences);
    for (std::size_t lane = 0; lane < range.end - range.begin; ++lane) write_point(tile, range, lane);
    write_lists(tile);
  }

 private:
  void set_head(int tile, const TileRange& range) {
    TileHead& head = out_.head[at(tile)];
    if (range.begin == range.end) return;
    Vec3d low = points_.X[at(cut_.order[range.begin])], high = low;
    for (std::size_t i = range.begin; i < range.end; ++i) {
      for (int a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], points_.X[at(cut_.order[i])][a]);
        high[a] = std::max(high[a], points_.X[at(cut_.order[i])][a]);
      }
    }
    for (int a = 0; a < 3; ++a) head.origin[a] = 0.5 * (low[a] + high[a]);
    head.blend = points_.blend[at(cut_.order[range.begin])];
  }

  void index_frames(int tile) {
    index_.clear();
    const int first = out_.tile_frame_begin[at(tile)];
    for (int i = first; i < out_.tile_frame_begin[at(tile) + 1]; ++i)
      index_.emplace_back(out_.tile_frames[at(i)].frame, static_cast<std::uint8_t>(i - first));
    std::sort(index_.begin(), index_.end());
  }

  void gather_influences(const TileRange& range, std::size_t lane) {
    const int q = cut_.order[range.begin + lane];
    for (std::size_t k = points_.begin[at(q)]; k < points_.begin[at(q) + 1]; ++k) {
      const int frame = frame_of_node_[at(points_.node[k])];
      const auto own = std::lower_bound(index_.begin(), index_.end(), std::pair<int, std::uint8_t>{frame, 0});
      const std::size_t place = lane * at(out_.influences) + (k - points_.begin[at(q)]);
      frames_[place] = own->second;
      number_[place] = static_cast<int>(k - points_.begin[at(q)]);
    }
  }

  void write_point(int tile, const TileRange& range, std::size_t lane) {
    const std::size_t P = at(out_.tile_size), K = at(out_.influences);
    const int q = cut_.order[range.begin + lane];
    for (std::size_t k = 0; k < K; ++k) {
      const int number = number_[lane * K + k];
      out_.local[(at(tile) * K + k) * P + lane] = frames_[lane * K + k];
      if (number < 0) continue;
      const std::size_t i = points_.begin[at(q)] + at(number);
      double* w = out_.weights.data() + (at(tile) * K + k) * 4 * P + lane;
      w[0] = points_.w[i];
      for (int a = 0; a < 3; ++a) w[at(a + 1) * P] = points_.g[i][a];
    }
    double* place = out_.places.data() + at(tile) * 4 * P + lane;
    for (int a = 0; a < 3; ++a) place[at(a) * P] = points_.X[at(q)][a] - out_.head[at(tile)].origin[a];
    place[3 * P] = points_.volume[at(q)];
    out_.material[at(tile) * P + lane] = static_cast<std::uint16_t>(points_.material[at(q)]);
    out_.source[at(tile) * P + lane] = points_.source.empty() ? q : points_.source[at(q)];
  }

  void write_lists(int tile) {
    const std::size_t P = at(out_.tile_size), K = at(out_.influences);
    const int count = out_.tile_frame_begin[at(tile) + 1] - out_.tile_frame_begin[at(tile)];
    lists_.resize(std::max(lists_.size(), at(count)));
    for (std::vector<std::uint16_t>& l : lists_) l.clear();
    for (std::size_t lane = 0; lane < P; ++lane)
      for (std::size_t k = 0; k < K; ++k)
        if (number_[lane * K + k] >= 0)
          lists_[frames_[lane * K + k]].push_back(static_cast<std::uint16_t>(k << kTileLaneBits | lane));
    spread_entries(std::span(lists_).first(at(count)));
    std::uint16_t* begin = out_.list_begin.data() + at(tile) * at(out_.list_stride());
    std::size_t n = 0;
    for (int f = 0; f < count; ++f) {
      begin[f] = static_cast<std::uint16_t>(n);
      for (const std::uint16_t entry : lists_[at(f)]) out_.list[at(tile) * K * P + n++] = entry;
    }
    begin[count] = static_cast<std::uint16_t>(n);
  }

  const TilePoints& points_;
  const TileCut& cut_;
  const std::vector<int>& frame_of_node_;
  TileLayout& out_;
  std::vector<std::pair<int, std::uint8_t>> index_;  ///< frames of the tile and their places, ascending
  std::vector<std::uint8_t> frames_;                 ///< (lanes × influences)
  std::vector<int> number_;                          ///< the same: which influence of the point, −1: none
  std::vector<std::vector<std::uint16_t>> lists_;
};

}  // namespace

std::optional<TileLayout> make_tiles(const TilePoints& points, const TileOptions& options, ThreadPool& pool) {
  assert(options.tile_size % 16 == 0 && options.tile_size <= 1 << kTileLaneBits);
  assert(options.most_frames <= kMostTileFrames);
  TileLayout out;
  out.tile_size = options.tile_size;
  out.influences = (std::max(1, points.most_influences()) + 3) / 4 * 4;
  if (out.influences > kMostTileInfluences || points.most_influences() > options.most_frames) return std::nullopt;
  if (out.influences * out.tile_size > 0xffff) return std::nullopt;
  out.drilling = points.drilling;
  out.materials = points.materials;
  const TileCut cut = cut_points(points, options.tile_size, options.most_frames);
  const std::vector<int> frame_of_node = number_frames(points, cut, out);
  const auto frames = collect_frames(points, cut, frame_of_node, options.most_frames, pool);
  out.tile_count = static_cast<int>(frames.size());
  place_partials(frames, out);
  assert(out.most_frames <= options.most_frames);

  const std::size_t tiles = at(out.tile_count), P = at(out.tile_size), K = at(out.influences);
  out.head.resize(tiles);
  out.weights.resize(tiles * K * 4 * P);
  out.places.resize(tiles * 4 * P);
  out.material.resize(tiles * P);
  out.local.resize(tiles * K * P);
  out.list.resize(tiles * K * P);
  out.list_begin.resize(tiles * at(out.list_stride()));
  out.source.assign(tiles * P, -1);
  pool.for_ranges(out.tile_count, 16, [&](int begin, int end) {
    TileFiller filler(points, cut, frame_of_node, out);
    for (int tile = begin; tile < end; ++tile) filler.fill(tile);
  });
  return out;
}

}  // namespace fascia
