#include "gpu/tiles/tile_split.hpp"

#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace fascia::tile_split_test {
namespace {

TileLayout layout_of_block() {
  test::BlockOptions o;
  o.grid = {7, 5, 4};
  const test::BuiltModel built = test::build({test::block_spec(o)});
  TilePointsResult points = tile_points(built.model.points, built.model.rest_position);
  for (int k = 0; k < 40; ++k) points.points.rest_position.push_back({{double(k), 9, 9}});  // without points
  ThreadPool pool(1);
  return *make_tiles(points.points, {32, 60}, pool);
}

/// First tile of each share in the whole layout.
std::vector<int> first_tiles(const std::vector<TileShare>& shares) {
  std::vector<int> first{0};
  for (const TileShare& s : shares) first.push_back(first.back() + s.layout.tile_count);
  return first;
}

TEST(TileSplit, KeepsEveryTileAndOwnsEveryFrameOnce) {
  const TileLayout all = layout_of_block();
  for (const int count : {1, 2, 3, 5, 8}) {
    const std::vector<TileShare> shares = split_tiles(all, count);
    const std::vector<int> first = first_tiles(shares);
    ASSERT_EQ(first.back(), all.tile_count);
    std::vector<int> owners(at(all.frame_count), 0);
    std::vector<int> sources;
    std::vector<int> writers;
    for (std::size_t s = 0; s < shares.size(); ++s) {
      const TileLayout& own = shares[s].layout;
      EXPECT_EQ(own.list_stride(), all.list_stride());
      writers.assign(at(own.frame_count), 0);
      sources.insert(sources.end(), own.source.begin(), own.source.end());
      for (int f = 0; f < shares[s].owned; ++f) ++owners[at(own.frame_node[at(f)])];
      for (int tile = 0; tile < own.tile_count; ++tile) {
        const int in_all = first[s] + tile, begin = own.tile_frame_begin[at(tile)];
        const int frames = own.tile_frame_begin[at(tile) + 1] - begin;
        ASSERT_EQ(frames, all.tile_frame_begin[at(in_all) + 1] - all.tile_frame_begin[at(in_all)]);
        for (int i = 0; i < frames; ++i) {
          const TileFrame& f = own.tile_frames[at(begin + i)];
          const TileFrame& g = all.tile_frames[at(all.tile_frame_begin[at(in_all)] + i)];
          EXPECT_EQ(own.frame_node[at(f.frame)], all.frame_node[at(g.frame)]);
          EXPECT_EQ(own.rest_position[at(f.frame)], all.rest_position[at(g.frame)]);
          EXPECT_EQ(f.owner, g.owner);
          EXPECT_TRUE(f.owner == 0 || f.frame < shares[s].owned);
          writers[at(f.frame)] += f.writer;
          EXPECT_EQ(own.slot_tile[at(f.slot)], tile);
          EXPECT_EQ(own.slot_tile_frame[at(f.slot)], begin + i);
        }
      }
      for (const int n : writers) EXPECT_EQ(n, 1);
    }
    EXPECT_EQ(sources, all.source);
    for (const int n : owners) EXPECT_EQ(n, 1);
  }
}

/// What stands in each slot after all exchanges is what the one layout has there.
TEST(TileSplit, ExportsWhatOthersSum) {
  const TileLayout all = layout_of_block();
  std::vector<int> frame_of_node(at(all.frame_count));
  for (int f = 0; f < all.frame_count; ++f) frame_of_node[at(all.frame_node[at(f)])] = f;
  for (const int count : {2, 3, 8}) {
    const std::vector<TileShare> shares = split_tiles(all, count);
    const std::vector<int> first = first_tiles(shares);
    std::vector<std::vector<int>> slots;
    for (std::size_t s = 0; s < shares.size(); ++s) {
      const TileLayout& own = shares[s].layout;
      slots.emplace_back(own.slot_tile.size(), -1);
      for (std::size_t slot = 0; slot < own.slot_tile.size(); ++slot) {
        if (own.slot_tile[slot] < 0) continue;
        const int in_all = all.tile_frame_begin[at(first[s])] + own.slot_tile_frame[slot];
        slots.back()[slot] = all.tile_frames[at(in_all)].slot;
      }
    }
    for (std::size_t s = 0; s < shares.size(); ++s)
      for (const TileExport& e : shares[s].partials) slots[at(e.share)][at(e.remote_row)] = slots[s][at(e.row)];
    for (std::size_t s = 0; s < shares.size(); ++s) {
      const TileLayout& own = shares[s].layout;
      for (int f = 0; f < own.frame_count; ++f) {
        const int g = frame_of_node[at(own.frame_node[at(f)])], begin = own.frame_slot_begin[at(f)];
        ASSERT_EQ(own.frame_slot_begin[at(f) + 1] - begin,
                  all.frame_slot_begin[at(g) + 1] - all.frame_slot_begin[at(g)]);
        for (int k = begin; k < own.frame_slot_begin[at(f) + 1]; ++k)
          EXPECT_EQ(slots[s][at(k)], all.frame_slot_begin[at(g)] + k - begin);
      }
    }
  }
}

/// Rows of a shared frame hold the shares that touch it, ascending, in every one of them.
TEST(TileSplit, ExportsOwnBlocksOfSharedFrames) {
  const TileLayout all = layout_of_block();
  const std::vector<TileShare> shares = split_tiles(all, 4);
  std::vector<std::vector<int>> touching(at(all.frame_count));
  for (std::size_t s = 0; s < shares.size(); ++s)
    for (const int node : shares[s].layout.frame_node) touching[at(node)].push_back(static_cast<int>(s));
  std::vector<std::vector<int>> rows;
  for (std::size_t s = 0; s < shares.size(); ++s) {
    rows.emplace_back(at(shares[s].shared_block_begin.back()), -1);
    for (const int row : shares[s].own_block) rows.back()[at(row)] = static_cast<int>(s);
  }
  for (std::size_t s = 0; s < shares.size(); ++s)
    for (const TileExport& e : shares[s].blocks) rows[at(e.share)][at(e.remote_row)] = rows[s][at(e.row)];
  for (std::size_t s = 0; s < shares.size(); ++s) {
    const TileShare& share = shares[s];
    std::size_t shared = 0;
    for (int f = 0; f < share.layout.frame_count; ++f) {
      const std::vector<int>& of_frame = touching[at(share.layout.frame_node[at(f)])];
      if (of_frame.size() == 1) continue;
      ASSERT_LT(shared, share.shared.size());
      EXPECT_EQ(share.shared[shared], f);
      const auto begin = rows[s].begin();
      EXPECT_EQ(
          std::vector<int>(begin + share.shared_block_begin[shared], begin + share.shared_block_begin[shared + 1]),
          of_frame);
      ++shared;
    }
    EXPECT_EQ(shared, share.shared.size());
  }
}

}  // namespace
}  // namespace fascia::tile_split_test
