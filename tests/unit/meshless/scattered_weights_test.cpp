#include "meshless/scattered/kept_weights.hpp"

#include "core/base/index.hpp"
#include "core/math/rotation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

namespace fascia::scattered_weights_test {
namespace {

static_assert(ScatteredWeightFunction<MlsWeights>);
static_assert(ScatteredWeightFunction<ShepardWeights>);
static_assert(ScatteredWeightFunction<WendlandWeights>);
static_assert(ScatteredWeightFunction<CubicSplineWeights>);

double uniform(std::mt19937& random, double min, double max) {
  return min + (max - min) * (static_cast<double>(random()) / 4294967296.0);
}
Vec3d uniform_vector(std::mt19937& random, double size) {
  const double a = uniform(random, -size, size), b = uniform(random, -size, size), c = uniform(random, -size, size);
  return {{a, b, c}};
}

/// Frames with spacing 1 and places among them.
struct Layout {
  std::string name;
  std::vector<Vec3d> frames;
  std::vector<ScatteredPlace> places;
  double support = 1.8;
  double variation = 0;  ///< of the support from frame to frame
};

/// Frames that reach X, or nearly so.
std::vector<NearFrame> frames_near(const Layout& layout, const Vec3d& X) {
  std::vector<NearFrame> near;
  for (std::size_t i = 0; i < layout.frames.size(); ++i) {
    const double support = layout.support * (1 + layout.variation * static_cast<double>(i % 3));
    if (norm(layout.frames[i] - X) < 1.05 * support) near.push_back({static_cast<int>(i), layout.frames[i], support});
  }
  return near;
}

const Mat3d kTilt = rotation_about(normalized(Vec3d{{1, 2, 3}}), 0.7);

Layout block(double jitter) {
  Layout r{"block", {}, {}};
  std::mt19937 random(1);
  for (int k = 0; k < 125; ++k) {
    const Vec3d x{{double(k % 5), double(k / 5 % 5), double(k / 25)}};
    r.frames.push_back(x + uniform_vector(random, jitter));
  }
  for (int n = 0; n < 60; ++n) r.places.push_back({uniform_vector(random, 2) + Vec3d{{2, 2, 2}}});
  for (int k = 0; k < 8; ++k) r.places.push_back({{{4.0 * (k & 1), 4.0 * (k >> 1 & 1), 4.0 * (k >> 2)}}});
  return r;
}

/// 7² frames and some places of a surface with about unit parameters.
template <class PlaceAt>
Layout surface(const std::string& name, double jitter, const PlaceAt& place_at) {
  Layout r{name, {}, {}};
  std::mt19937 random(2);
  for (int k = 0; k < 49; ++k) {
    const Vec3d shift = uniform_vector(random, jitter);
    r.frames.push_back(place_at(k % 7 - 3 + shift[0], k / 7 - 3 + shift[1]).X);
  }
  for (int n = 0; n < 60; ++n) {
    const Vec3d at_random = uniform_vector(random, 3);
    r.places.push_back(place_at(at_random[0], at_random[1]));
  }
  return r;
}

Layout plane(double jitter) {
  return surface("plane", jitter, [](double a, double b) {
    return ScatteredPlace{kTilt * Vec3d{{a, b, 0.3}}, kTilt, 2};
  });
}

/// A patch of a sphere of radius 5.
Layout sphere(double jitter) {
  return surface("sphere", jitter, [](double a, double b) {
    const Mat3d basis = basis_from({{a, b, 5}});
    return ScatteredPlace{basis.row(0) * 5, Mat3d::from_columns(basis.row(1), basis.row(2), basis.row(0)), 2};
  });
}

/// 10 frames and some places of a curve with unit parameter.
template <class PlaceAt>
Layout curve(const std::string& name, double jitter, const PlaceAt& place_at) {
  Layout r{name, {}, {}};
  std::mt19937 random(4);
  for (int k = 0; k < 10; ++k) r.frames.push_back(place_at(k + uniform(random, -jitter, jitter)).X);
  for (int n = 0; n < 40; ++n) r.places.push_back(place_at(uniform(random, 0, 9)));
  return r;
}

Layout line(double jitter) {
  return curve("line", jitter, [](double s) { return ScatteredPlace{kTilt.column(0) * s, kTilt, 1}; });
}

/// Part of a circle of radius 4.
Layout arc(double jitter) {
  return curve("arc", jitter, [](double s) {
    const Mat3d turned = kTilt * rotation_about({{0, 0, 1}}, s / 4);
    return ScatteredPlace{turned.column(0) * 4,
                          Mat3d::from_columns(turned.column(1), turned.column(2), turned.column(0)), 1};
  });
}

/// A line of frames that leaves a block: solid places in both, line places along the line.
Layout mixture(double jitter) {
  Layout r = block(jitter);
  r.name = "mixture";
  std::mt19937 random(6);
  for (int k = 1; k < 6; ++k) r.frames.push_back({{4 + k + uniform(random, -jitter, jitter), 2.1, 1.8}});
  for (int n = 0; n < 40; ++n) {
    const double x = uniform(random, 3, 9), y = uniform(random, 2, 2.2), z = uniform(random, 1.7, 1.9);
    r.places.push_back({{{x, y, z}}});
    r.places.push_back({{{x, 2.1, 1.8}}, Mat3d::identity(), 1});
  }
  return r;
}

/// Regular ones, and jittered ones with supports that differ.
std::vector<Layout> all_layouts() {
  std::vector<Layout> r;
  for (const double jitter : {0.0, 0.2})
    for (Layout (*layout)(double) : {block, plane, sphere, line, arc, mixture}) {
      r.push_back(layout(jitter));
      r.back().variation = jitter;
    }
  return r;
}

Mat3d tangent_projector(const ScatteredPlace& place) {
  Mat3d r;
  for (int a = 0; a < place.dimension; ++a) r += outer(place.axes.column(a), place.axes.column(a));
  return r;
}

/// Checks what weights promise, with gradients of about 1 / spacing; gives the largest gradient.
double expect_identities(const ScatteredWeights& weights, const Layout& layout, const ScatteredPlace& place) {
  double sum = 0, largest = 0;
  Vec3d gradient, offset;
  Mat3d slope;
  for (std::size_t i = 0; i < weights.w.size(); ++i) {
    const Vec3d d = layout.frames[at(weights.frame[i])] - place.X;
    sum += weights.w[i];
    gradient += weights.gradient[i];
    offset += d * weights.w[i];
    slope += outer(d, weights.gradient[i]);
    largest = std::max(largest, norm(weights.gradient[i]));
  }
  const Mat3d &P = weights.consistent, T = tangent_projector(place);
  EXPECT_NEAR(sum, 1, 1e-14) << layout.name;
  EXPECT_LT(norm(gradient), 1e-13) << layout.name;
  EXPECT_LT(norm(slope - slope * T), 1e-13 * (1 + largest)) << layout.name;
  EXPECT_LT(norm(P * offset), 1e-12) << layout.name;
  EXPECT_LT(norm(P * slope - P), 1e-12) << layout.name;
  EXPECT_LT(norm(P * P - P) + norm(T * P - P), 1e-12) << layout.name;
  return largest;
}

/// One entry for each frame, 0 for those without weight.
struct Dense {
  std::vector<double> w;
  std::vector<Vec3d> gradient;
};
Dense dense(const ScatteredWeights& weights, std::size_t count) {
  Dense r{std::vector<double>(count), std::vector<Vec3d>(count)};
  for (std::size_t i = 0; i < weights.w.size(); ++i) {
    r.w[at(weights.frame[i])] = weights.w[i];
    r.gradient[at(weights.frame[i])] = weights.gradient[i];
  }
  return r;
}

double difference(const Dense& a, const Dense& b) {
  double r = 0;
  for (std::size_t i = 0; i < a.w.size(); ++i) r = std::max(r, std::abs(a.w[i] - b.w[i]));
  return r;
}

/// Largest difference of the gradients from central differences along the tangents.
template <class W>
double gradient_error(const ScatteredPlace& place, const std::vector<NearFrame>& near, std::size_t count) {
  const Dense here = dense(W::at(place, near), count);
  double r = 0;
  for (int a = 0; a < place.dimension; ++a) {
    const Vec3d t = place.axes.column(a), step = t * 1e-6;
    const Dense plus = dense(W::at({place.X + step, place.axes, place.dimension}, near), count);
    const Dense minus = dense(W::at({place.X - step, place.axes, place.dimension}, near), count);
    for (std::size_t i = 0; i < count; ++i)
      r = std::max(r, std::abs((plus.w[i] - minus.w[i]) / 2e-6 - dot(here.gradient[i], t)));
  }
  return r;
}

template <class W>
class Scattered : public testing::Test {};
using Kinds = testing::Types<MlsWeights, ShepardWeights, WendlandWeights, CubicSplineWeights>;
TYPED_TEST_SUITE(Scattered, Kinds);

TYPED_TEST(Scattered, KeepTheirIdentities) {
  for (const Layout& layout : all_layouts()) {
    for (const ScatteredPlace& place : layout.places) {
      const ScatteredWeights w = TypeParam::at(place, frames_near(layout, place.X));
      EXPECT_LT(expect_identities(w, layout, place), 100) << layout.name;
      EXPECT_TRUE(std::is_sorted(w.frame.begin(), w.frame.end()));
      EXPECT_TRUE(TypeParam::kReproducesLinear || w.consistent == Mat3d{});
    }
  }
}

TYPED_TEST(Scattered, GradientIsThatOfTheWeights) {
  for (const Layout& layout : all_layouts()) {
    int compared = 0;
    for (const ScatteredPlace& place : layout.places) {
      const std::vector<NearFrame> near = frames_near(layout, place.X);
      if (TypeParam::at(place, near).lowered) continue;  // the kept directions turn with X
      ++compared;
      EXPECT_LT(gradient_error<TypeParam>(place, near, layout.frames.size()), 1e-7) << layout.name;
    }
    EXPECT_GE(compared, 40) << layout.name;
  }
}

TYPED_TEST(Scattered, TurnMoveAndScaleWithTheMatter) {
  const Mat3d R = rotation_about(normalized(Vec3d{{3, -1, 2}}), 2.1);
  const Vec3d t{{3, -4, 5}};
  for (const double scale : {1.0, 1e-3, 1e3}) {
    for (const Layout& layout : all_layouts()) {
      Layout moved{layout.name, {}, {}, layout.support * scale, layout.variation};
      for (const Vec3d& x : layout.frames) moved.frames.push_back((R * x + t) * scale);
      for (const ScatteredPlace& place : layout.places) {
        const ScatteredPlace there{(R * place.X + t) * scale, R * place.axes, place.dimension};
        const ScatteredWeights w = TypeParam::at(place, frames_near(layout, place.X));
        const ScatteredWeights w_there = TypeParam::at(there, frames_near(moved, there.X));
        EXPECT_EQ(w.lowered, w_there.lowered);
        EXPECT_LT(norm(w_there.consistent - R * times_transpose(w.consistent, R)), 1e-11) << layout.name;
        const Dense a = dense(w, layout.frames.size()), b = dense(w_there, layout.frames.size());
        EXPECT_LT(difference(a, b), 1e-12) << layout.name;
        for (std::size_t i = 0; i < a.w.size(); ++i)
          EXPECT_LT(norm(b.gradient[i] * scale - R * a.gradient[i]), 1e-11) << layout.name;
      }
    }
  }
}

TYPED_TEST(Scattered, DoNotDependOnTheOrderOfFrames) {
  const Layout layout = block(0.2);
  for (const ScatteredPlace& place : layout.places) {
    std::vector<NearFrame> near = frames_near(layout, place.X);
    const ScatteredWeights a = TypeParam::at(place, near);
    std::reverse(near.begin(), near.end());
    std::rotate(near.begin(), near.begin() + 3, near.end());
    const ScatteredWeights b = TypeParam::at(place, near);
    EXPECT_EQ(a.frame, b.frame);
    EXPECT_EQ(a.w, b.w);
    EXPECT_EQ(a.gradient, b.gradient);
  }
}

TYPED_TEST(Scattered, AreSmoothAtTheEdgeOfASupportAndAtAFrame) {
  const Layout layout = block(0.2);
  for (const std::size_t i : {0u, 31u, 62u, 84u}) {
    for (const double radius : {layout.support, 0.0}) {
      const Vec3d direction = normalized(Vec3d{{2, 2, 2.3}} - layout.frames[i]);
      const auto at_distance = [&](double r) {
        const Vec3d X = layout.frames[i] + direction * r;
        return dense(TypeParam::at({X}, frames_near(layout, layout.frames[i] + direction * radius)), 125);
      };
      const Dense before = at_distance(radius - 1e-7), there = at_distance(radius), after = at_distance(radius + 1e-7);
      EXPECT_LT(difference(before, there), 1e-6);
      EXPECT_LT(difference(there, after), 1e-6);
      for (std::size_t j = 0; j < 125; ++j) EXPECT_LT(norm(before.gradient[j] - after.gradient[j]), 1e-4);
    }
  }
}

TYPED_TEST(Scattered, OfAFrameAloneOrOfNone) {
  const Vec3d x{{1, 2, 3}};
  for (const Vec3d& X : {x, x + Vec3d{{0.3, 0, 0.1}}, x + Vec3d{{0, 1e-9, 0}}}) {
    const ScatteredWeights w = TypeParam::at({X}, std::vector<NearFrame>{{7, x, 0.5}});
    ASSERT_EQ(w.frame, std::vector<int>{7});
    EXPECT_EQ(w.w[0], 1);
    EXPECT_EQ(norm(w.gradient[0]), 0);
    EXPECT_EQ(w.consistent, Mat3d{});
  }
  EXPECT_TRUE(TypeParam::at({x}, {}).frame.empty());
}

TEST(MlsWeights, ReproduceLinearFieldsWhereFramesSpread) {
  for (const Layout& layout : all_layouts()) {
    int lowered = 0;
    for (const ScatteredPlace& place : layout.places) {
      const ScatteredWeights w = MlsWeights::at(place, frames_near(layout, place.X));
      EXPECT_EQ(w.lowered, trace(w.consistent) < place.dimension - 0.5) << layout.name;
      lowered += w.lowered ? 1 : 0;
    }
    const bool has_thin_part = layout.name == "mixture";
    EXPECT_EQ(lowered >= 10, has_thin_part) << layout.name;
    EXPECT_EQ(lowered > 0, has_thin_part) << layout.name;
  }
}

/// Solid places above and on a plane or a line of frames.
TEST(MlsWeights, LowerTheOrderAcrossCoplanarAndCollinearFrames) {
  for (const double jitter : {0.0, 0.2}) {
    for (const Layout& layout : {plane(jitter), line(jitter)}) {
      for (const ScatteredPlace& place : layout.places) {
        for (const double height : {0.0, 1e-9, 0.2}) {
          const std::vector<NearFrame> near = frames_near(layout, place.X);
          const ScatteredPlace solid{place.X + place.axes.column(2) * height};
          const ScatteredWeights w = MlsWeights::at(solid, near);
          EXPECT_TRUE(w.lowered);
          EXPECT_LT(norm(w.consistent - tangent_projector(place)), 1e-10) << height;
          expect_identities(w, layout, solid);
          EXPECT_LT(gradient_error<MlsWeights>(solid, near, layout.frames.size()), 1e-7);
        }
      }
    }
  }
}

/// Frames nearly in a plane: a basis with the third direction would have weights and slopes beyond reason.
TEST(MlsWeights, StayModerateAsFramesFlatten) {
  for (const double flatness : {1.0, 0.3, 0.1, 0.03, 1e-2, 1e-4, 1e-8, 1e-12, 0.0}) {
    Layout layout = block(0.2);
    for (Vec3d& x : layout.frames) x[2] = 2 + (x[2] - 2) * flatness;
    for (const ScatteredPlace& place : layout.places) {
      const ScatteredPlace near_plane{{{place.X[0], place.X[1], 2 + 0.2 * (place.X[2] - 2)}}};
      const ScatteredWeights w = MlsWeights::at(near_plane, frames_near(layout, near_plane.X));
      double size = 0;
      for (const double v : w.w) size += std::abs(v);
      EXPECT_LT(size, 20) << flatness;
      EXPECT_LT(expect_identities(w, layout, near_plane), 60) << flatness;
    }
  }
}

TEST(ShepardWeights, OfAPlaceOnAFrameAreThatFrame) {
  const Layout layout = block(0.2);
  const ScatteredWeights w = ShepardWeights::at({layout.frames[62]}, frames_near(layout, layout.frames[62]));
  EXPECT_EQ(w.frame, std::vector<int>{62});
  EXPECT_EQ(w.w, std::vector<double>{1});
}

/// Shepard's weights of the closest frames.
auto shepard(std::size_t count, int power) {
  return [=](const ScatteredPlace& place, std::vector<NearFrame> near) {
    std::stable_sort(near.begin(), near.end(), [&](const NearFrame& a, const NearFrame& b) {
      return squared_norm(a.x - place.X) < squared_norm(b.x - place.X);
    });
    near.resize(count);
    return ShepardWeights::at(place, near, power);
  };
}

/// Reference values for 5³ frames and 12³ places, made by another program.
TEST(Consistency, OfTheWeightFunctionsIsThatMeasured) {
  for (const double jitter : {0.0, 0.2}) {
    Layout layout = block(jitter);
    layout.places.clear();
    for (int k = 0; k < 12 * 12 * 12; ++k)
      layout.places.push_back({{{(k % 12 + 0.5) / 3, (k / 12 % 12 + 0.5) / 3, (k / 144 + 0.5) / 3}}});
    const auto expect = [&](double support, const auto& weights_at, const Consistency& regular,
                            const Consistency& jittered) {
      layout.support = support;
      std::vector<ScatteredWeights> weights;
      for (const ScatteredPlace& place : layout.places)
        weights.push_back(weights_at(place, frames_near(layout, place.X)));
      ThreadPool pool(2);
      const KeptWeights kept(
          weights.size(), [&](std::size_t p) { return weights[p]; }, pool);
      const Consistency c = consistency(kept, layout.frames, layout.places, 1);
      const Consistency& expected = jitter > 0 ? jittered : regular;
      EXPECT_NEAR(c.position, expected.position, 0.2 * expected.position + 1e-14);
      EXPECT_NEAR(c.gradient, expected.gradient, 0.2 * expected.gradient + 1e-14);
    };
    expect(10, shepard(4, 2), {0.19, 0.65}, {0.20, 0.65});
    expect(10, shepard(8, 2), {0.12, 0.50}, {0.14, 0.52});
    expect(10, shepard(8, 4), {0.17, 0.95}, {0.22, 0.82});
    expect(1.5, WendlandWeights::at, {0.09, 0.38}, {0.17, 0.50});
    expect(2.0, WendlandWeights::at, {0.05, 0.15}, {0.11, 0.25});
    expect(1.5, CubicSplineWeights::at, {0.06, 0.27}, {0.15, 0.42});
    expect(2.0, CubicSplineWeights::at, {0.08, 0.17}, {0.12, 0.24});
    expect(1.8, MlsWeights::at, {}, {});
  }
}

}  // namespace
}  // namespace fascia::scattered_weights_test
