#include "meshless/scattered/owned_pieces.hpp"

#include "core/base/errors.hpp"
#include "meshless/scattered/kept_weights.hpp"
#include "meshless/scattered/scatter.hpp"
#include "tests/unit/meshless/matter_samples.hpp"

#include <gtest/gtest.h>

#include <random>

namespace fascia::owned_pieces_test {
namespace {

/// Pieces of a loop's chunk have owners that began in earlier chunks, in the same one, and none; one owner has pieces
/// all over.
TEST(OwnedPieces, AreTakenOwnerByOwnerInTheirOrder) {
  constexpr int kPieces = 700'000, kOwners = 900, kEverywhere = kOwners - 2;  // the last one has none
  std::mt19937 random(3);
  std::vector<int> owner;
  for (int p = 0; p < kPieces; ++p) {
    const int near = static_cast<int>(1LL * p * (kOwners - 40) / kPieces) + static_cast<int>(random() % 36);
    owner.push_back(random() % 5 == 0 ? -1 : p % 10'007 == 0 ? kEverywhere : near);
  }
  std::vector<std::vector<std::size_t>> wanted(kOwners);
  for (std::size_t p = 0; p < owner.size(); ++p)
    if (owner[p] >= 0) wanted[at(owner[p])].push_back(p);
  EXPECT_GT(wanted[kEverywhere].size(), 40U);
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    std::vector<std::vector<std::size_t>> taken(kOwners);  // one chunk alone appends to each
    OwnedPieces(owner, kOwners).for_each(pool, [&](std::size_t p, std::size_t own) { taken[own].push_back(p); });
    EXPECT_EQ(taken, wanted) << threads;
  }
}

TEST(OwnedPieces, MayBeNone) {
  ThreadPool pool(2);
  const auto count = [&](const std::vector<int>& owner, std::size_t owners) {
    int taken = 0;
    OwnedPieces(owner, owners).for_each(pool, [&](std::size_t, std::size_t) { ++taken; });
    return taken;
  };
  EXPECT_EQ(count({}, 0), 0);
  EXPECT_EQ(count({}, 5), 0);
  EXPECT_EQ(count({-1, -1}, 5), 0);
  EXPECT_EQ(count({-1, 4, -1}, 5), 1);
}

/// Darts of a box and their shares: enough pieces for several chunks, and for darts that are asked in their own order.
TEST(Sampling, IsThatOfOneThread) {
  std::vector<std::vector<double>> found;
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    Matter box;
    add_solid(box, test::box_domain({}, {{3, 2, 2}}), 0.05, PieceUse::points, pool);
    const std::vector<SamplePlace> places = poisson_disk(box, 0.5, 1, false, pool);
    std::vector<double>& numbers = found.emplace_back();
    for (const Share& s : voronoi_shares(box, places, pool))
      numbers.insert(numbers.end(), {s.centroid[0], s.centroid[1], s.centroid[2], s.volume});
    EXPECT_EQ(places.size(), 96U);
  }
  EXPECT_EQ(found[0], found[1]);
}

/// From none to thirty frames a place, over several stretches of places.
TEST(KeptWeights, AreThoseThatWereFound) {
  std::mt19937 random(4);
  std::vector<ScatteredWeights> found(1700);
  for (ScatteredWeights& r : found) {
    for (unsigned k = random() % 31; k > 0; --k) {
      r.frame.push_back(static_cast<int>(random() % 1000));
      r.w.push_back(1.0 * random());
      r.gradient.push_back({{1.0 * random(), 1.0 * random(), 1.0 * random()}});
    }
    r.consistent(1, 2) = 1.0 * random();
    r.lowered = random() % 2 == 0;
    r.spread = 1.0 * random();
  }
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    const KeptWeights kept(
        found.size(), [&](std::size_t p) { return found[p]; }, pool);
    ASSERT_EQ(kept.size(), found.size());
    for (std::size_t p = 0; p < found.size(); ++p) {
      const WeightsView view = kept[p];
      EXPECT_EQ(std::vector<int>(view.frame.begin(), view.frame.end()), found[p].frame);
      EXPECT_EQ(std::vector<double>(view.w.begin(), view.w.end()), found[p].w);
      EXPECT_EQ(std::vector<Vec3d>(view.gradient.begin(), view.gradient.end()), found[p].gradient);
      EXPECT_EQ(view.consistent, found[p].consistent);
      EXPECT_EQ(view.lowered, found[p].lowered);
      EXPECT_EQ(view.spread, found[p].spread);
    }
  }
  ThreadPool pool(2);
  for (ScatteredWeights& r : found) r.consistent = found[0].consistent;
  const auto own = [&](std::size_t p) { return found[p]; };
  const KeptWeights alike(found.size(), own, pool);
  EXPECT_EQ(alike[1699].consistent, found[0].consistent);
  EXPECT_EQ(alike.size(), found.size());
  EXPECT_TRUE(KeptWeights(0, own, pool).empty());
}

TEST(KeptWeights, LetErrorsThrough) {
  ThreadPool pool(2);
  const auto refuse = [](std::size_t p) -> ScatteredWeights {
    if (p == 900) throw InputError("no weights there");
    return {};
  };
  EXPECT_THROW(KeptWeights(1700, refuse, pool), InputError);
}

}  // namespace
}  // namespace fascia::owned_pieces_test
