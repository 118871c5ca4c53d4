#include "core/math/half_angle.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/shell_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

namespace fascia::shell_derivatives_test {
namespace {

using namespace test;

struct Case {
  std::string name;
  std::function<ShellModel()> build;
  double rotation = 0.4;  ///< of the frames [rad]
  double dt = 0;
};

Vec3d dome(double u, double v) { return {{u, v, 0.6 * u * (1 - u) + 0.3 * u * v}}; }

std::vector<Case> cases() {
  const auto shell = [](const ShellMatter& matter, double jitter) {
    return [=] { return shell_model(patch_mesh(dome, {3, 3, Diagonals::alternating, jitter}), matter); };
  };
  const auto mixed = [] {
    ShellBodySpec spec = shell_spec(patch_mesh(dome, {3, 3, Diagonals::alternating, 0.2}), {.thickness = 0.05});
    for (std::size_t t = 0; t < spec.material.size(); ++t)
      if (t % 2 == 0)
        spec.material[t].viscosity = two_branches();
      else
        spec.material[t].stiffness_damping = 0.02;
    return shell_model(std::move(spec));
  };
  ShellMatter fading{.thickness = 0.05, .viscosity = two_branches()};
  ShellMatter thick{1e4, 0.3, 0.2}, thin{1e4, 0.45, 0.01}, viscous{1e4, 0.3, 0.05, 1000, 0.02};
  return {{"thick", shell(thick, 0.2)},
          {"thin", shell(thin, 0.2)},
          {"much turned", shell(thick, 0), 1.2},
          {"hardly turned", shell(thick, 0), 1e-3},
          {"viscous", shell(viscous, 0.2), 0.4, 0.05},
          {"fading", shell(fading, 0.2)},
          {"fading beside viscous", mixed, 0.4, 0.05}};
}

class ShellDerivatives : public DerivativeTest<Case, ShellModel> {
 protected:
  ShellDerivatives() : DerivativeTest(GetParam().build(), 0.02, GetParam().rotation) {}
};

TEST_P(ShellDerivatives, GradientIsThatOfTheEnergy) { expect_gradient_of_the_energy(); }

TEST_P(ShellDerivatives, TangentIsTheSecondDerivativeAlongExponentials) {
  expect_second_derivative_along_exponentials();
}

TEST_P(ShellDerivatives, DifferencesOfTheGradientAreTangentMinusHalfTorque) {
  expect_differences_to_be_tangent_minus_half_torque();
}

TEST_P(ShellDerivatives, AssembledMatrixEqualsTheProduct) { expect_assembled_equals_product(); }

TEST_P(ShellDerivatives, ExtrapolatedStressesAreOfSecondOrder) { expect_extrapolation_of_second_order(); }

TEST_P(ShellDerivatives, MaterialTangentIsSymmetricAndNotNegative) { expect_symmetric_and_not_negative(); }

INSTANTIATE_TEST_SUITE_P(Shells, ShellDerivatives, testing::ValuesIn(cases()), [](const auto& parameter) {
  std::string name = parameter.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

/// Series and closed forms of φ / sin φ, and their derivatives, on both sides of where they meet.
TEST(HalfAngle, DerivativesAgreeAcrossTheJoint) {
  for (const double z : {0.005, 0.01, 0.0199, 0.0201, 0.05, 0.3, 0.7, 0.95}) {
    const double h = 1e-5 * std::min(z, 1 - z);
    const HalfAngle<double> at(z), plus(z + h), minus(z - h);
    const double angle = 2 * std::asin(std::sqrt(z));
    EXPECT_NEAR(at.f, angle / std::sin(angle), 4e-15 * at.f / (1 - z)) << z;  // the sine loses digits near π
    EXPECT_NEAR(at.df, (plus.f - minus.f) / (2 * h), 1e-7 * at.df) << z;      // rounding over h
    EXPECT_NEAR(at.ddf, (plus.df - minus.df) / (2 * h), 1e-6 * at.ddf) << z;
    Lanes lanes;
    for (int i = 0; i < kBatchWidth; ++i) lanes.v[i] = i % 2 == 0 ? z : 0.01;
    const HalfAngle<Lanes> batch(lanes);
    EXPECT_NEAR(batch.ddf.v[0], at.ddf, 1e-11 * at.ddf);
    EXPECT_NEAR(batch.ddf.v[1], HalfAngle<double>(0.01).ddf, 1e-11);
  }
}

}  // namespace
}  // namespace fascia::shell_derivatives_test
