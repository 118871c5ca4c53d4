// Where St Venant-Kirchhoff's law gives way.
#include "core/physics/ellipticity.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace fascia {
namespace {

Lame usual() { return Lame::from_young(1, 0.3); }

Mat3d stretched(double along, double across) {
  Mat3d F = Mat3d::identity() * across;
  F(0, 0) = along;
  return F;
}

/// A bar whose sides are free.
Mat3d bar(double stretch) { return stretched(stretch, std::sqrt(1 - 0.3 * (stretch * stretch - 1))); }

/// @param height  of what is sheared; 1/√(1 + shear²) where nothing holds its faces apart: a pure shear strain
Mat3d sheared(double shear, double height) {
  Mat3d F = Mat3d::identity();
  F(0, 1) = shear * height;
  F(1, 1) = height;
  return F;
}
Mat3d sheared_freely(double shear) { return sheared(shear, 1 / std::hypot(1, shear)); }

TEST(Ellipticity, IsLostUnderPressureAndByShearOfFreeFaces) {
  EXPECT_TRUE(is_strongly_elliptic(usual(), Mat3d::identity()));
  EXPECT_TRUE(is_strongly_elliptic(usual(), bar(0.6)));
  EXPECT_FALSE(is_strongly_elliptic(usual(), bar(0.58)));
  EXPECT_TRUE(is_strongly_elliptic(usual(), bar(2)));
  EXPECT_TRUE(is_strongly_elliptic(usual(), sheared_freely(0.98)));
  EXPECT_FALSE(is_strongly_elliptic(usual(), sheared_freely(1.02)));
  EXPECT_TRUE(is_strongly_elliptic(usual(), sheared(2, 1))) << "walls hold the faces apart";
  EXPECT_TRUE(is_strongly_elliptic(usual(), Mat3d::identity() * std::numeric_limits<double>::quiet_NaN()));
}

double energy(const Lame& m, const Mat3d& F) {
  const Mat3d E = (transpose_times(F, F) - Mat3d::identity()) * 0.5;
  return 0.5 * m.lambda * trace(E) * trace(E) + m.mu * contract(E, E);
}

/// Without contraction walls do not hold: there the law gives way between them too, and a free face sooner.
TEST(Ellipticity, DependsOnPoissonsRatio) {
  const Lame cork = Lame::from_young(1, 0), soft = Lame::from_young(1, 0.4);
  EXPECT_TRUE(is_strongly_elliptic(cork, sheared(1.1, 1)));
  EXPECT_FALSE(is_strongly_elliptic(cork, sheared(1.17, 1)));
  EXPECT_TRUE(is_strongly_elliptic(cork, sheared_freely(0.86)));
  EXPECT_FALSE(is_strongly_elliptic(cork, sheared_freely(0.9)));
  EXPECT_TRUE(is_strongly_elliptic(soft, sheared_freely(1.04)));
  EXPECT_FALSE(is_strongly_elliptic(soft, sheared_freely(1.08)));
  for (const double stretch : {1.5, 3.0, 6.0}) EXPECT_TRUE(is_strongly_elliptic(cork, stretched(stretch, 1)));
}

/// Second differences of the energy along m ⊗ n, random ones: no negative one where the law is elliptic; one of many
/// is negative where it clearly is not.
TEST(Ellipticity, IsWhatSecondDifferencesOfTheEnergySay) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> of(-1, 1);
  const auto direction = [&] {
    const Vec3d v{{of(random), of(random), of(random)}};
    return v * (1 / norm(v));
  };
  const auto least = [&](const Mat3d& F) {
    constexpr double h = 1e-4;
    double smallest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 20000; ++k) {
      const Mat3d d = outer(direction(), direction()) * h;
      smallest =
          std::min(smallest, (energy(usual(), F + d) - 2 * energy(usual(), F) + energy(usual(), F - d)) / (h * h));
    }
    return smallest;
  };
  for (const Mat3d& F : {bar(0.8), bar(0.62), bar(1.8), sheared_freely(0.9), sheared(1.5, 1)}) {
    EXPECT_TRUE(is_strongly_elliptic(usual(), F));
    EXPECT_GT(least(F), 0);
  }
  for (const Mat3d& F : {bar(0.5), sheared_freely(1.3), stretched(0.5, 0.9)}) {
    EXPECT_FALSE(is_strongly_elliptic(usual(), F));
    EXPECT_LT(least(F), 0);
  }
}

}  // namespace
}  // namespace fascia
