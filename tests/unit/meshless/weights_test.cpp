#include "meshless/weights.hpp"
#include "meshless/gauss.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

namespace fascia::weights_test {
namespace {

static_assert(GridWeights<TrilinearWeights>);
static_assert(GridWeights<LinearWeights>);

Vec3d corner_position(int corner) {
  return {{static_cast<double>(corner & 1), static_cast<double>(corner >> 1 & 1), static_cast<double>(corner >> 2)}};
}

template <class W>
class Weights : public testing::Test {};
using Kinds = testing::Types<TrilinearWeights, LinearWeights>;
TYPED_TEST_SUITE(Weights, Kinds);

/// Inside the cell and outside, where cut cells use them.
TYPED_TEST(Weights, ArePartitionOfUnityAndLinearConsistent) {
  std::mt19937 random(3);
  for (int n = 0; n < 200; ++n) {
    const Vec3d xi = test::random_vector(random, 1.5);
    const auto w = TypeParam::at(xi);
    double sum = 0;
    Vec3d gradient_sum, position;
    Mat3d slope;
    for (std::size_t k = 0; k < w.w.size(); ++k) {
      sum += w.w[k];
      gradient_sum += w.gradient[k];
      position += corner_position(w.corner[k]) * w.w[k];
      slope += outer(corner_position(w.corner[k]), w.gradient[k]);
    }
    EXPECT_NEAR(sum, 1, 1e-14);
    EXPECT_LT(norm(gradient_sum), 1e-14);
    EXPECT_LT(norm(position - xi), 1e-14);
    EXPECT_LT(norm(slope - Mat3d::identity()), 1e-14);
  }
}

TYPED_TEST(Weights, GradientIsThatOfTheWeights) {
  std::mt19937 random(4);
  for (int n = 0; n < 50; ++n) {
    const Vec3d xi = test::random_vector(random, 0.4) + Vec3d{{0.5, 0.5, 0.5}};
    const auto w = TypeParam::at(xi);
    for (int a = 0; a < 3; ++a) {
      Vec3d e;
      e[a] = 1e-6;
      const auto plus = TypeParam::at(xi + e), minus = TypeParam::at(xi - e);
      if (plus.corner != w.corner || minus.corner != w.corner) continue;  // across a tetrahedron's face
      for (std::size_t k = 0; k < w.w.size(); ++k) EXPECT_NEAR((plus.w[k] - minus.w[k]) / 2e-6, w.gradient[k][a], 1e-9);
    }
  }
}

TYPED_TEST(Weights, AreContinuousAcrossTetrahedra) {
  const Vec3d xi{{0.4, 0.4, 0.2}}, e{{1e-9, 0, 0}};
  const auto value = [](const auto& w) {
    std::array<double, 8> all{};
    for (std::size_t k = 0; k < w.w.size(); ++k) all[static_cast<std::size_t>(w.corner[k])] = w.w[k];
    return all;
  };
  const auto a = value(TypeParam::at(xi + e)), b = value(TypeParam::at(xi - e));
  for (std::size_t k = 0; k < 8; ++k) EXPECT_NEAR(a[k], b[k], 1e-8);
}

TEST(GaussLegendre, IsExactUpToItsDegree) {
  for (int n = 1; n <= 10; ++n) {
    for (int degree = 0; degree < 2 * n; ++degree) {
      double sum = 0;
      for (const GaussPoint& p : gauss_legendre(n)) sum += p.weight * std::pow(p.x, degree);
      EXPECT_NEAR(sum, 1.0 / (degree + 1), 1e-14) << n << " points, degree " << degree;
    }
  }
}

}  // namespace
}  // namespace fascia::weights_test
