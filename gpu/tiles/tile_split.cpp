#include "gpu/tiles/tile_split.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <utility>

namespace fascia {

namespace {

/// Which shares touch a frame: bit s is share s.
using Shares = std::uint32_t;

class Splitter {
 public:
  Splitter(const TileLayout& all, int shares) : all_(all), shares_(shares), touching_(at(all.frame_count), 0) {
    for (int s = 0; s < shares_; ++s) {
      first_.push_back(static_cast<int>(std::int64_t{all_.tile_count} * s / shares_));
      last_.push_back(static_cast<int>(std::int64_t{all_.tile_count} * (s + 1) / shares_));
      for (int i = begin_of(s); i < end_of(s); ++i) touching_[at(all_.tile_frames[at(i)].frame)] |= Shares{1} << s;
    }
  }

  std::vector<TileShare> split() {
    std::vector<TileShare> out(at(shares_));
    for (int s = 0; s < shares_; ++s) number_frames(s, out[at(s)]);
    for (int s = 0; s < shares_; ++s) {
      place_tiles(s, out[at(s)]);
      export_blocks(s, out[at(s)]);
    }
    return out;
  }

 private:
  int begin_of(int share) const { return all_.tile_frame_begin[at(first_[at(share)])]; }
  int end_of(int share) const { return all_.tile_frame_begin[at(last_[at(share)])]; }
  bool touches(int share, int frame) const { return (touching_[at(frame)] >> share & 1U) != 0; }
  bool is_shared(int frame) const { return (touching_[at(frame)] & (touching_[at(frame)] - 1)) != 0; }
  int slots_of(int frame) const { return all_.frame_slot_begin[at(frame) + 1] - all_.frame_slot_begin[at(frame)]; }

  void number_frames(int share, TileShare& out) {
    std::vector<int> owned, others;
    for (int i = begin_of(share); i < end_of(share); ++i) {
      const TileFrame& f = all_.tile_frames[at(i)];
      (f.owner != 0 ? owned : others).push_back(f.frame);
    }
    std::sort(owned.begin(), owned.end());
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    std::erase_if(others, [&](int f) { return std::binary_search(owned.begin(), owned.end(), f); });
    out.owned = static_cast<int>(owned.size());
    std::vector<int>& local = local_.emplace_back(at(all_.frame_count), -1);
    place_.emplace_back(at(all_.frame_count), -1);
    TileLayout& l = out.layout;
    l.frame_slot_begin.assign(1, 0);
    out.shared_block_begin.assign(1, 0);
    owned.insert(owned.end(), others.begin(), others.end());
    for (const int f : owned) {
      local[at(f)] = l.frame_count++;
      l.frame_node.push_back(all_.frame_node[at(f)]);
      l.rest_position.push_back(all_.rest_position[at(f)]);
      l.frame_slot_begin.push_back(l.frame_slot_begin.back() + slots_of(f));
      if (is_shared(f)) add_shared(share, f, out);
    }
    slot_begin_.push_back(l.frame_slot_begin);
    block_begin_.push_back(out.shared_block_begin);
  }

  void add_shared(int share, int frame, TileShare& out) {
    place_.back()[at(frame)] = static_cast<int>(out.shared.size());
    out.shared.push_back(local_.back()[at(frame)]);
    int rank = 0, count = 0;
    for (int s = 0; s < shares_; ++s) {
      if (s < share) rank += touches(s, frame);
      count += touches(s, frame);
    }
    out.own_block.push_back(out.shared_block_begin.back() + rank);
    out.shared_block_begin.push_back(out.shared_block_begin.back() + count);
  }

  /// The part of an array of `words` numbers a tile that belongs to a share.
  template <class T>
  std::vector<T> part(const std::vector<T>& of_all, int share, std::size_t words) const {
    const auto begin = of_all.begin();
    return {begin + static_cast<std::ptrdiff_t>(at(first_[at(share)]) * words),
            begin + static_cast<std::ptrdiff_t>(at(last_[at(share)]) * words)};
  }

  void place_tiles(int share, TileShare& out) {
    TileLayout& l = out.layout;
    l.tile_size = all_.tile_size;
    l.influences = all_.influences;
    l.tile_count = last_[at(share)] - first_[at(share)];
    l.most_frames = all_.most_frames;
    l.drilling = all_.drilling;
    l.materials = all_.materials;
    const std::size_t P = at(l.tile_size), K = at(l.influences);
    l.head = part(all_.head, share, 1);
    l.weights = part(all_.weights, share, 4 * K * P);
    l.places = part(all_.places, share, 4 * P);
    l.material = part(all_.material, share, P);
    l.local = part(all_.local, share, K * P);
    l.list = part(all_.list, share, K * P);
    l.list_begin = part(all_.list_begin, share, at(all_.list_stride()));
    l.source = part(all_.source, share, P);
    l.slot_tile.assign(at(l.frame_slot_begin.back()), -1);
    l.slot_tile_frame.assign(at(l.frame_slot_begin.back()), -1);
    l.tile_frame_begin.assign(1, 0);
    std::vector<bool> written(at(l.frame_count), false);
    for (int tile = first_[at(share)]; tile < last_[at(share)]; ++tile) {
      for (int i = all_.tile_frame_begin[at(tile)]; i < all_.tile_frame_begin[at(tile) + 1]; ++i) {
        const TileFrame& from = all_.tile_frames[at(i)];
        const int slot = local_slot(share, from);
        l.slot_tile[at(slot)] = tile - first_[at(share)];
        l.slot_tile_frame[at(slot)] = static_cast<int>(l.tile_frames.size());
        const int frame = local_[at(share)][at(from.frame)];
        l.tile_frames.push_back({frame, slot, from.owner, written[at(frame)] ? 0 : 1});
        written[at(frame)] = true;
        for (int other = 0; other < shares_; ++other)
          if (other != share && touches(other, from.frame))
            out.partials.push_back({slot, other, local_slot(other, from)});
      }
      l.tile_frame_begin.push_back(static_cast<int>(l.tile_frames.size()));
    }
  }

  int local_slot(int share, const TileFrame& frame) const {
    const int first = slot_begin_[at(share)][at(local_[at(share)][at(frame.frame)])];
    return first + frame.slot - all_.frame_slot_begin[at(frame.frame)];
  }

  void export_blocks(int share, TileShare& out) const {
    for (int f = 0; f < all_.frame_count; ++f) {
      const int own = place_[at(share)][at(f)];
      if (own < 0) continue;
      const int rank = out.own_block[at(own)] - out.shared_block_begin[at(own)];
      for (int s = 0; s < shares_; ++s)
        if (s != share && touches(s, f))
          out.blocks.push_back({out.own_block[at(own)], s, block_begin_[at(s)][at(place_[at(s)][at(f)])] + rank});
    }
  }

  const TileLayout& all_;
  int shares_;
  std::vector<int> first_, last_;
  std::vector<Shares> touching_;
  std::vector<std::vector<int>> local_;  ///< (shares, frames) their numbers, or −1
  std::vector<std::vector<int>> place_;  ///< (shares, frames) among the shared ones, or −1
  std::vector<std::vector<int>> slot_begin_, block_begin_;
};

}  // namespace

std::vector<TileShare> split_tiles(const TileLayout& tiles, int shares) {
  assert(shares > 0 && shares <= tiles.tile_count && shares <= kMostShares);
  return Splitter(tiles, shares).split();
}

TileShare whole_share(TileLayout tiles) {
  TileShare share;
  share.owned = tiles.frame_count;
  share.layout = std::move(tiles);
  return share;
}

}  // namespace fascia
