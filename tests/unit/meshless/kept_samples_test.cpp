// Samples that a store kept take the place of those that would be made, and no others.
#include "meshless/kept_samples.hpp"
#include "core/math/rotation.hpp"
#include "tests/unit/meshless/shared_models.hpp"

#include <gtest/gtest.h>

#include <map>

namespace fascia::kept_samples_test {
namespace {

using namespace test;

class MemoryStore : public SampleStore {
 public:
  std::optional<std::string> find(std::string_view description) const override {
    const auto found = kept.find(std::string(description));
    if (found == kept.end()) return std::nullopt;
    ++taken;
    return found->second;
  }
  bool wants(double) const override { return true; }
  void keep(std::string_view description, std::string_view bytes) const override {
    kept.insert_or_assign(std::string(description), std::string(bytes));
  }

  mutable std::map<std::string, std::string> kept;
  mutable int taken = 0;
};

/// Frames and points of the unit block, as numbers.
std::vector<double> sampled(const ScatterSpec& scatter) {
  CloudSpec spec;
  static_cast<BodyMatter&>(spec) = block_spec({});
  std::vector<std::string> messages;
  scatter_cloud(scatter, spec, messages);
  std::vector<double> numbers{spec.spacing};
  for (const CloudFrame& f : spec.frames)
    for (int a = 0; a < 3; ++a) numbers.push_back(f.x[a]);
  for (const CloudPoint& p : spec.points) {
    for (int a = 0; a < 3; ++a) numbers.push_back(p.place.X[a]);
    numbers.push_back(p.volume);
  }
  return numbers;
}

TEST(KeptSamples, AreTheSameBitForBit) {
  const MemoryStore store;
  ScatterSpec scatter = unit_scatter(CountedChoice{40, 1});
  const std::vector<double> plain = sampled(scatter);
  scatter.store = &store;
  EXPECT_EQ(sampled(scatter), plain);
  EXPECT_EQ(store.kept.size(), 2u);  // frames, points
  EXPECT_EQ(store.taken, 0);
  EXPECT_EQ(sampled(scatter), plain);
  EXPECT_EQ(store.taken, 2);
  scatter.weights = ScatteredKind::shepard;  // says nothing of where they are
  sampled(scatter);
  EXPECT_EQ(store.taken, 4);
}

TEST(KeptSamples, AreOfTheirOwnGeometryAlone) {
  const ScatterSpec plain = unit_scatter(CountedChoice{15, 1});
  MemoryStore first;
  ScatterSpec made = plain;
  made.store = &first;
  sampled(made);
  const auto taken_of = [&](const std::function<void(ScatterSpec&)>& change) {
    MemoryStore store;
    store.kept = first.kept;
    ScatterSpec scatter = plain;
    scatter.store = &store;
    change(scatter);
    sampled(scatter);
    return store.taken;
  };
  EXPECT_EQ(taken_of([](ScatterSpec&) {}), 2);
  EXPECT_LE(taken_of([](ScatterSpec& s) { s.frames = CountedChoice{15, 2}; }), 1);  // points where the spacing is equal
  EXPECT_EQ(taken_of([](ScatterSpec& s) { s.frames = CountedChoice{20, 1}; }), 0);
  EXPECT_EQ(taken_of([](ScatterSpec& s) { s.points = SpacedChoice{0.11, 1}; }), 1);  // the frames are as they were
  EXPECT_EQ(taken_of([](ScatterSpec& s) { s.parts.translation = {{1, 0, 0}}; }), 0);
  EXPECT_EQ(taken_of([](ScatterSpec& s) { s.parts.rotation = rotation_about({{0, 0, 1}}, 0.3); }), 0);
  EXPECT_LE(taken_of([](ScatterSpec& s) { s.shared = {{0, {{1, 1, 1}}, {}, true}}; }), 1);  // keeps a frame off
  EXPECT_EQ(taken_of([](ScatterSpec& s) { s.parts.solid->surface.points[3][1] += 1e-9; }), 0);
  EXPECT_EQ(
      taken_of([](ScatterSpec& s) { s.parts.solid->contains = [](const Vec3d& x) { return x[0] + x[1] < 1.5; }; }), 0);
  EXPECT_EQ(taken_of([](ScatterSpec& s) {
              s.frames = ListedChoice{{{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}, {{1, 1, 1}}}, {}, {}};
            }),
            0);
}

TEST(KeptSamples, OfWrongLengthAreMadeAgain) {
  const MemoryStore store;
  ScatterSpec scatter = unit_scatter(CountedChoice{15, 1});
  scatter.store = &store;
  const std::vector<double> made = sampled(scatter);
  for (auto& [description, bytes] : store.kept) bytes.pop_back();
  EXPECT_EQ(sampled(scatter), made);
  for (auto& [description, bytes] : store.kept) bytes = "";
  EXPECT_EQ(sampled(scatter), made);
}

}  // namespace
}  // namespace fascia::kept_samples_test
