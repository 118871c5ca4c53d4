#include "tests/support/derivatives.hpp"
#include "tests/unit/meshless/shared_models.hpp"

#include <ostream>

/// Forces and tangents of meshless bodies that share nodes, and of finite elements whose nodes turn for them.
namespace fascia::shared_derivatives_test {
namespace {

using namespace test;

struct Case {
  std::string name;
  HostOptions host;
  bool affine = false;
  double dt = 0;
  bool uniform = false;  ///< all nodes are rigid frames
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](const std::string& name, HostKind kind, auto change) {
    Case c;
    c.name = name;
    c.host.kind = kind;
    change(c);
    all.push_back(c);
  };
  add("still", HostKind::still, [](Case&) {});
  add("turning", HostKind::turning, [](Case&) {});
  add("all_turning", HostKind::turning, [](Case& c) {
    c.host.all = c.uniform = true;
    c.host.cells = 1;
  });
  add("turning_averaged", HostKind::turning, [](Case& c) { c.host.averaged = true; });
  add("all_turning_averaged", HostKind::turning, [](Case& c) {
    c.host.all = c.uniform = c.host.averaged = true;
    c.host.cells = 1;
  });
  add("turning_viscous", HostKind::turning, [](Case& c) {
    c.host.damping = 0.02;
    c.dt = 0.05;
  });
  add("turning_affine", HostKind::turning, [](Case& c) { c.affine = true; });
  add("still_affine", HostKind::still, [](Case& c) { c.affine = true; });
  add("frames_affine", HostKind::frames, [](Case& c) { c.affine = true; });
  add("rigid", HostKind::rigid, [](Case&) {});
  add("rigid_affine", HostKind::rigid, [](Case& c) { c.affine = true; });
  return all;
}

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

SharedModel built(const Case& c) {
  SharedModel s;
  add_host(s, c.host);
  BlockOptions o;
  o.affine = c.affine;
  o.stiffness_damping = c.host.damping;
  add_cloud(s, unit_scatter(SpacedChoice{0.5, 1}), o);
  s.finish();
  return s;
}

class SharedDerivatives : public DerivativeTest<Case, SharedModel> {
 protected:
  SharedDerivatives() : DerivativeTest(built(GetParam()), 0.03, 0.4) {}
};

TEST_P(SharedDerivatives, GradientIsThatOfTheEnergy) { expect_gradient_of_the_energy(); }

TEST_P(SharedDerivatives, TangentIsTheDerivativeOfTheGradient) { expect_differences_to_be_tangent_minus_half_torque(); }

TEST_P(SharedDerivatives, TangentIsTheSecondDerivative) { expect_second_derivative_along_exponentials(); }

TEST_P(SharedDerivatives, AssembledMatrixEqualsTheProduct) {
  EXPECT_EQ(BlockMatrix(built_.model.points).fills_upper(), GetParam().uniform || (GetParam().name == "rigid"));
  expect_assembled_equals_product();
}

TEST_P(SharedDerivatives, MaterialTangentIsSymmetricAndNotNegative) { expect_symmetric_and_not_negative(); }

INSTANTIATE_TEST_SUITE_P(All, SharedDerivatives, testing::ValuesIn(cases()),
                         [](const auto& parameter) { return parameter.param.name; });

}  // namespace
}  // namespace fascia::shared_derivatives_test
