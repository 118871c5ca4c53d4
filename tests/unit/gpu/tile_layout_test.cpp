#include "gpu/tiles/tile_layout.hpp"

#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace fascia::tile_layout_test {
namespace {

using test::BlockOptions;

TilePoints points_of(const test::BuiltModel& built) {
  TilePointsResult result = tile_points(built.model.points, built.model.rest_position);
  EXPECT_EQ(result.refusal, "");
  return result.points;
}

/// What a layout says of a point's influence, by node.
struct Found {
  double w;
  Vec3d g;
};

Vec3d place_in(const TileLayout& t, int tile, int lane) {
  Vec3d X;
  for (int a = 0; a < 3; ++a)
    X[a] = t.places[(at(tile) * 4 + at(a)) * at(t.tile_size) + at(lane)] + t.head[at(tile)].origin[a];
  return X;
}

std::map<int, Found> influences_in(const TileLayout& t, int tile, int lane) {
  std::map<int, Found> found;
  const std::size_t P = at(t.tile_size), K = at(t.influences);
  for (std::size_t k = 0; k < K; ++k) {
    const double* w = t.weights.data() + (at(tile) * K + k) * 4 * P + at(lane);
    const Found f{w[0], {{w[P], w[2 * P], w[3 * P]}}};
    if (f.w == 0 && squared_norm(f.g) == 0) continue;
    const int local = t.local[(at(tile) * K + k) * P + at(lane)];
    const TileFrame& frame = t.tile_frames[at(t.tile_frame_begin[at(tile)] + local)];
    EXPECT_TRUE(found.emplace(t.frame_node[at(frame.frame)], f).second);
  }
  return found;
}

void expect_whole(const TilePoints& points, const TileLayout& t) {
  std::map<int, int> point_of_source;
  for (int q = 0; q < points.point_count(); ++q) point_of_source[points.source[at(q)]] = q;
  int count = 0;
  for (int tile = 0; tile < t.tile_count; ++tile) {
    for (int lane = 0; lane < t.tile_size; ++lane) {
      const int source = t.source[at(tile) * at(t.tile_size) + at(lane)];
      if (source < 0) continue;
      ++count;
      const int q = point_of_source.at(source);
      EXPECT_LT(norm(place_in(t, tile, lane) - points.X[at(q)]), 1e-14);
      EXPECT_EQ(t.head[at(tile)].blend, points.blend[at(q)]);
      const std::map<int, Found> found = influences_in(t, tile, lane);
      EXPECT_EQ(static_cast<int>(found.size()), points.influence_count(q));
      for (std::size_t k = points.begin[at(q)]; k < points.begin[at(q) + 1]; ++k) {
        EXPECT_EQ(found.at(points.node[k]).w, points.w[k]);
        EXPECT_EQ(found.at(points.node[k]).g, points.g[k]);
      }
    }
  }
  EXPECT_EQ(count, points.point_count());
}

/// Each influence stands in the list of its frame, each frame has one owner, partials of a frame are contiguous.
void expect_gathered(const TilePoints& points, const TileLayout& t) {
  const std::size_t P = at(t.tile_size), K = at(t.influences);
  std::size_t entries = 0;
  std::vector<int> owners(at(t.frame_count), 0);
  std::set<int> slots;
  for (int tile = 0; tile < t.tile_count; ++tile) {
    const std::uint16_t* begin = t.list_begin.data() + at(tile) * at(t.list_stride());
    for (int f = 0; f < t.tile_frame_begin[at(tile) + 1] - t.tile_frame_begin[at(tile)]; ++f) {
      const TileFrame& frame = t.tile_frames[at(t.tile_frame_begin[at(tile)] + f)];
      owners[at(frame.frame)] += frame.owner;
      EXPECT_TRUE(slots.insert(frame.slot).second);
      EXPECT_GE(frame.slot, t.frame_slot_begin[at(frame.frame)]);
      EXPECT_LT(frame.slot, t.frame_slot_begin[at(frame.frame) + 1]);
      EXPECT_EQ(t.slot_tile[at(frame.slot)], tile);
      EXPECT_EQ(t.slot_tile_frame[at(frame.slot)], t.tile_frame_begin[at(tile)] + f);
      for (int e = begin[f]; e < begin[f + 1]; ++e) {
        const int entry = t.list[at(tile) * K * P + at(e)];
        const std::size_t lane = at(entry & ((1 << kTileLaneBits) - 1)), k = at(entry >> kTileLaneBits);
        EXPECT_EQ(t.local[(at(tile) * K + k) * P + lane], f);
        ++entries;
      }
    }
  }
  EXPECT_EQ(entries, points.node.size());
  for (const int n : owners) EXPECT_EQ(n, 1);
}

TEST(TilePoints, FollowFromInfluences) {
  for (const bool half : {true, false}) {
    for (const GridWeightKind weights : {GridWeightKind::trilinear, GridWeightKind::linear}) {
      BlockOptions o;
      o.half_blend = half;
      o.weights = weights;
      o.rotation = rotation_about(normalized(Vec3d{{1, 2, 3}}), 0.7);
      o.translation = {{3, -2, 5}};
      const test::BuiltModel built = test::build({test::block_spec(o)});
      const TilePoints points = points_of(built);
      ASSERT_EQ(points.point_count(), built.model.points.point_count);
      EXPECT_EQ(points.most_influences(), weights == GridWeightKind::trilinear ? 8 : 4);
      EXPECT_TRUE(points.drilling);
      EXPECT_EQ(points.materials.size(), 1U);
      for (int q = 0; q < points.point_count(); ++q) {
        EXPECT_EQ(points.blend[at(q)], half ? 0.5 : 1.0);
        double sum = 0;
        Vec3d X;
        for (std::size_t k = points.begin[at(q)]; k < points.begin[at(q) + 1]; ++k) {
          sum += points.w[k];
          X += points.rest_position[at(points.node[k])] * points.w[k];
        }
        EXPECT_NEAR(sum, 1, 1e-14);
        EXPECT_LT(norm(X - points.X[at(q)]), 1e-13);
      }
    }
  }
}

TEST(TilePoints, RefusesWhatTilesCannotCompute) {
  BlockOptions o;
  o.affine = true;
  const test::BuiltModel built = test::build({test::block_spec(o)});
  EXPECT_NE(tile_points(built.model.points, built.model.rest_position).refusal, "");

  const test::BuiltModel solid = test::build({test::block_spec(BlockOptions{})});
  PointSet set = solid.model.points;
  set.shape[4 * kGroupSize] += 1e-6;  // B of one influence
  EXPECT_NE(tile_points(set, solid.model.rest_position).refusal, "");
}

TEST(TileLayout, HoldsEveryInfluenceOnce) {
  ThreadPool pool(2);
  BlockOptions o;
  o.grid = {7, 5, 4};
  BlockOptions full = o;
  full.half_blend = false;
  full.translation = {{3, 0, 0}};
  const test::BuiltModel built = test::build({test::block_spec(o), test::block_spec(full)});
  const TilePoints points = points_of(built);
  for (const TileOptions& options : {TileOptions{256, 255}, TileOptions{48, 255}, TileOptions{32, 20}}) {
    const auto layout = make_tiles(points, options, pool);
    ASSERT_TRUE(layout.has_value());
    EXPECT_LE(layout->most_frames, options.most_frames);
    expect_whole(points, *layout);
    expect_gathered(points, *layout);
  }
}

TEST(TileLayout, FramesWithoutPointsHaveAnOwner) {
  ThreadPool pool(1);
  TilePoints points = points_of(test::build({test::block_spec(BlockOptions{})}));
  for (int k = 0; k < 300; ++k) points.rest_position.push_back({{double(k), 9, 9}});
  const auto layout = make_tiles(points, {128, 255}, pool);
  ASSERT_TRUE(layout.has_value());
  EXPECT_EQ(layout->frame_count, points.node_count());
  expect_whole(points, *layout);
  expect_gathered(points, *layout);
}

TEST(TileLayout, RefusesPointsOfTooManyFrames) {
  ThreadPool pool(1);
  TilePoints points = points_of(test::build({test::block_spec(BlockOptions{})}));
  EXPECT_FALSE(make_tiles(points, {128, 7}, pool).has_value());
}

}  // namespace
}  // namespace fascia::tile_layout_test
