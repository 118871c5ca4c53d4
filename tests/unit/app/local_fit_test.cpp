// Interpolation between scattered places, as fascia compare does it in meshless bodies.
#include "app/compare/local_fit.hpp"

#include "core/base/index.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace fascia::app::local_fit_test {
namespace {

using Function = std::function<double(const Vec3d&)>;

/// Places in the box [0, 2] × [0, 1] × [0, depth], always the same.
std::vector<Vec3d> scattered(int count, double depth) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0, 1);
  std::vector<Vec3d> places;
  places.reserve(at(count));
  for (int i = 0; i < count; ++i) places.push_back({{2 * part(random), part(random), depth * part(random)}});
  return places;
}

double value_at(const LocalFit& fit, const Vec3d& X, const Function& f) {
  double sum = 0;
  for (const auto& [place, weight] : fit.shares_at(X)) sum += weight * f(fit.places()[at(place)]);
  return sum;
}

double quadratic(const Vec3d& x) {
  return 1 + x[0] - 2 * x[1] + 0.5 * x[2] + x[0] * x[0] - 3 * x[0] * x[1] + x[2] * x[2] + x[1] * x[2];
}

void expect_quadratics(const std::vector<Vec3d>& places, double depth) {
  const LocalFit fit(places);
  for (const Vec3d& X : {Vec3d{{1, 0.5, 0.5 * depth}}, Vec3d{{0.3, 0.7, 0.2 * depth}}, Vec3d{{1.7, 0.4, 0.9 * depth}}})
    EXPECT_NEAR(value_at(fit, X, quadratic), quadratic(X), 1e-9) << X[0];
}

TEST(LocalFit, MeetsQuadratics) { expect_quadratics(scattered(800, 1), 1); }

/// A sheet may lie in a plane; nothing is known across it.
TEST(LocalFit, MeetsQuadraticsOfAPlane) { expect_quadratics(scattered(300, 0), 0); }

TEST(LocalFit, MeetsQuadraticsOfALine) {
  std::vector<Vec3d> places;
  for (int i = 0; i <= 20; ++i) places.push_back({{0.1 * i, 0.05 * i, 0}});
  const Vec3d X{{0.77, 0.385, 0}};
  EXPECT_NEAR(value_at(LocalFit(places), X, quadratic), quadratic(X), 1e-9);
}

TEST(LocalFit, MeetsTheValuesAtThePlaces) {
  const std::vector<Vec3d> places = scattered(100, 1);
  const LocalFit fit(places);
  const auto shares = fit.shares_at(places[17]);
  ASSERT_EQ(shares.size(), 1u);
  EXPECT_EQ(shares[0].first, 17);
  // Beside one, nearly its value, whatever the others hold.
  const auto alone = [&](const Vec3d& x) { return x == places[17] ? 1.0 : 0.0; };
  EXPECT_NEAR(value_at(fit, places[17] + Vec3d{{1e-5, 0, 0}}, alone), 1, 1e-2);
}

TEST(LocalFit, AddsUpToOneAndDoesNotRelyOnDifferences) {
  const LocalFit fit(scattered(60, 1));
  for (const Vec3d& X : {Vec3d{{0, 0, 0}}, Vec3d{{2, 1, 1}}, Vec3d{{3, 2, -1}}, Vec3d{{1, 0.5, 0.5}}}) {
    double sum = 0, magnitude = 0;
    for (const auto& share : fit.shares_at(X)) {
      sum += share.second;
      magnitude += std::abs(share.second);
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_LE(magnitude, 3);
  }
}

TEST(LocalFit, LeavesAPlaceOut) {
  const std::vector<Vec3d> places = scattered(100, 1);
  for (const auto& [place, weight] : LocalFit(places).shares_at(places[17], 17)) EXPECT_NE(place, 17);
}

TEST(LocalFit, OfOnePlaceIsItsValue) {
  const LocalFit fit(std::vector<Vec3d>{{{1, 2, 3}}});
  EXPECT_EQ(fit.shares_at({{5, 5, 5}}), (std::vector<LocalFit::Share>{{0, 1.0}}));
}

/// A sphere's places obey an equation of degree 2, so that the polynomial is not unique: its value is.
TEST(LocalFit, KnowsCurvedSurfaces) {
  std::vector<Vec3d> places;
  constexpr int n = 600;
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2.0 * i + 1) / n, angle = 2.399963229728653 * i, r = std::sqrt(1 - z * z);
    places.push_back({{r * std::cos(angle), r * std::sin(angle), z}});
  }
  const LocalFit fit(places);
  for (const Vec3d& X : {normalized(Vec3d{{1, 2, 3}}), normalized(Vec3d{{-3, 1, 0.2}})})
    EXPECT_NEAR(value_at(fit, X, quadratic), quadratic(X), 1e-3);  // spacing³ of 0.14³
}

}  // namespace
}  // namespace fascia::app::local_fit_test
