#include "app/scene/laws.hpp"
#include "core/math/rotation.hpp"
#include "core/physics/element_law.hpp"
#include "tests/support/dual.hpp"
#include "tests/support/law_constants.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace fascia::test::laws_test {
namespace {

constexpr double kLambda = 3e4, kMu = 2e4;

Mat3d random_matrix(int seed, double size) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> uniform(-size, size);
  Mat3d m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = uniform(random);
  return m;
}

Mat3<Dual> along(const Mat3d& value, const Mat3d& direction) {
  Mat3<Dual> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = {value(i, j), direction(i, j)};
  return m;
}

double largest(const Mat3d& m) { return std::sqrt(contract(m, m)); }

/// Every law of solids, as elements, points and results know it. @tparam L  its name in a type
template <class L>
class LawsTest : public testing::Test {
 protected:
  template <class T>
  using Solid = SolidLaw<L::value, T>;
  static constexpr bool kSmall = Solid<double>::kSmall;
  template <class T>
  static Solid<T> make() {
    Solid<T> law;
    law.lambda = kLambda;
    law.mu = kMu;
    const std::vector<double> own = own_constants(L::value, kMu);
    if constexpr (Solid<T>::kOwn > 0) std::copy(own.begin(), own.end(), law.own);
    return law;
  }
  const Solid<double> law = make<double>();

  /// F S, or S where small: the derivative of ψ with respect to F.
  Mat3d first_piola(const Mat3d& H) const {
    const Mat3d S = second_piola(law, H);
    return kSmall ? S : S + H * S;
  }
  static Mat3d strain_differential(const Mat3d& H, const Mat3d& dF) {
    return kSmall ? sym(dF) : sym(dF + transpose_times(H, dF));
  }
};

using Laws =
    testing::Types<std::integral_constant<Law, Law::st_venant_kirchhoff>, std::integral_constant<Law, Law::neo_hookean>,
                   std::integral_constant<Law, Law::mooney_rivlin>, std::integral_constant<Law, Law::linear>>;
TYPED_TEST_SUITE(LawsTest, Laws);

TYPED_TEST(LawsTest, StressIsTheEnergysDerivative) {
  for (const int seed : {1, 2, 3}) {
    const Mat3d H = random_matrix(seed, 0.2), dF = random_matrix(10 + seed, 1);
    const auto dual = TestFixture::template make<Dual>();
    const double dpsi = energy_density(dual, along(H, dF)).d, expected = contract(this->first_piola(H), dF);
    EXPECT_NEAR(dpsi, expected, 1e-12 * kMu);
  }
}

TYPED_TEST(LawsTest, VolumetricGradientIsThatOfTheStrain) {
  using DualSolid = typename TestFixture::template Solid<Dual>;
  for (const int seed : {1, 2, 3}) {
    const Mat3d H = random_matrix(seed, 0.2), dF = random_matrix(10 + seed, 1);
    EXPECT_NEAR(DualSolid::volumetric_strain(along(H, dF)).d,
                contract(TestFixture::template Solid<double>::volumetric_gradient(H), dF), 1e-13);
  }
}

TYPED_TEST(LawsTest, StressDifferentialIsThatOfTheStressAndSymmetric) {
  for (const int seed : {1, 2, 3}) {
    const Mat3d H = random_matrix(seed, 0.2), a = random_matrix(10 + seed, 1), b = random_matrix(20 + seed, 1);
    const auto dual = TestFixture::template make<Dual>();
    const Mat3<Dual> S = second_piola(dual, along(H, a));
    const Mat3d Ea = this->strain_differential(H, a), Eb = this->strain_differential(H, b);
    const Mat3d dS = second_piola_differential(this->law, H, Ea);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(S(i, j).d, dS(i, j), 1e-11 * kMu);
    EXPECT_NEAR(contract(dS, Eb), contract(second_piola_differential(this->law, H, Eb), Ea), 1e-11 * kMu);
  }
}

TYPED_TEST(LawsTest, RestIsFreeOfStress) {
  EXPECT_EQ(largest(second_piola(this->law, Mat3d{})), 0);
  EXPECT_EQ(energy_density(this->law, Mat3d{}), 0);
}

TYPED_TEST(LawsTest, SmallStrainsMakeHookesStress) {
  const double size = 1e-6;
  const Mat3d H = random_matrix(5, size), E = sym(H);
  const Mat3d hooke = Mat3d::diagonal(kLambda * trace(E)) + E * (2 * kMu);
  EXPECT_LE(largest(second_piola(this->law, H) - hooke), 10 * size * largest(hooke));
}

/// The stand-in of "material" for the differential is never negative, and equals it at rest.
TYPED_TEST(LawsTest, PositivePartIsPositive) {
  using Known = typename TestFixture::template Solid<double>;
  const double k = this->law.volumetric_modulus();
  for (int seed = 1; seed <= 20; ++seed) {
    const Mat3d H = random_matrix(seed, 0.3), dE = sym(random_matrix(100 + seed, 1));
    const double p = k * Known::volumetric_strain(H);
    const typename Known::At at(H), rest(Mat3d{});
    EXPECT_GE(contract(this->law.second_piola_differential(at, p, k, dE, false), dE), 0);
    EXPECT_GE(contract(this->law.second_piola_differential(at, p, 0, dE, false), dE), 0);
    EXPECT_LE(largest(this->law.second_piola_differential(rest, 0, k, dE, false) -
                      this->law.second_piola_differential(rest, 0, k, dE, true)),
              1e-12 * kMu);
  }
}

/// A rotation after any deformation changes neither energy nor S; of small strain there is no such claim.
TYPED_TEST(LawsTest, DoNotSeeRotations) {
  if (TestFixture::kSmall) return;
  const Mat3d H = random_matrix(7, 0.2), D = rotation_increment({{1.1, -0.4, 2.0}});
  const Mat3d turned = D + H + D * H;
  EXPECT_NEAR(energy_density(this->law, turned), energy_density(this->law, H), 1e-12 * kMu);
  EXPECT_LE(largest(second_piola(this->law, turned) - second_piola(this->law, H)), 1e-11 * kMu);
  EXPECT_LE(energy_density(this->law, D), 1e-25 * kMu);
}

/// Blocks against products, with damping, an averaged pressure and both tangents.
TYPED_TEST(LawsTest, StiffnessBlocksAreProducts) {
  constexpr Law L = TypeParam::value;
  const Mat3d H = random_matrix(11, 0.2), old = sym(random_matrix(12, 0.1));
  const Vec3d ga{{0.3, -1.2, 0.5}}, gb{{0.9, 0.4, -0.7}};
  for (const double viscosity : {0.0, 0.8}) {
    for (const bool averaged : {false, true}) {
      for (const bool full : {false, true}) {
        ElementSolid<L, double> m;
        m.lambda = kLambda;
        m.mu = kMu;
        m.viscosity = viscosity;
        m.penalty = 0;
        if constexpr (SolidLaw<L, double>::kOwn > 0) std::copy_n(this->law.own, SolidLaw<L, double>::kOwn, m.own);
        const double modulus = this->law.volumetric_modulus();
        const double p = averaged ? 1.5e3 : modulus * SolidLaw<L, double>::volumetric_strain(H);
        const double k = averaged ? 0 : modulus;
        const ElasticPoint<L, double> point(H, m, p, old, viscosity > 0);
        const ElementStiffness<L, double> stiffness(point, m, k, full, viscosity > 0);
        const Mat3d K = stiffness.block(stiffness.node(ga), stiffness.node(gb));
        for (int j = 0; j < 3; ++j) {
          Vec3d unit{};
          unit[j] = 1;
          const Vec3d column = point.differential(outer(unit, gb), m, k, full) * ga;
          for (int i = 0; i < 3; ++i) EXPECT_NEAR(K(i, j), column[i], 1e-10 * kMu);
        }
      }
    }
  }
}

TEST(SolidLaws, SwitchesNameEveryLaw) {
  for (const Law law : kSolidLaws) EXPECT_TRUE(with_solid_law(law, [&]<Law L>() { return L == law; }));
  for (const app::LawWord& known : app::kMaterialLaws)
    EXPECT_TRUE(std::find(std::begin(kSolidLaws), std::end(kSolidLaws), known.law) != std::end(kSolidLaws))
        << known.word;
}

}  // namespace
}  // namespace fascia::test::laws_test
