#include "core/math/rotation.hpp"
#include "core/node/positive_inverse.hpp"
#include "core/solver/mechanical_system.hpp"
#include "core/structure/inertia.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <cstdio>

/// What affine frames, thin bodies and tethers add to loads, inertia and coordinates, against differences and by hand.
namespace fascia::affine_test {
namespace {

using namespace test;

/// A time step of every kind of body, with gravity, damping and a tether that moves.
TEST(Step, GradientAndSlopeAreThoseOfItsEnergy) {
  BlockOptions rigid;
  rigid.mass_damping = 3;
  rigid.stiffness_damping = 0.01;
  BlockOptions affine = rigid;
  affine.affine = true;
  affine.drilling = 0.003;
  for (const char* kind : {"affine", "sheet", "affine line"}) {
    const std::string name = kind;
    BuiltModel built = name == "affine"  ? block(affine)
                       : name == "sheet" ? build_cloud(thin_spec({4, 3}, rigid))
                                         : build_cloud(thin_spec({5}, affine));
    add_gravity(built.model, {{1, -9.81, 2}});
    ThreadPool pool(1);
    MechanicalSystem system(built.model, pool, {});
    State start = random_state(built.model, 0.01, 0.2);
    std::mt19937 random(5);
    for (Vec3d& v : start.v) v = random_vector(random, 1);
    for (std::size_t i = 0; i < start.Q_dot.size(); ++i)
      start.Q_dot[i] = skew(random_vector(random, 2)) * (Mat3d::identity() + start.D[i]);
    system.set_factors(std::vector<double>{0.7});
    system.begin_step(start, 0.02);
    system.evaluate();
    system.direction();
    system.apply(0.3);
    system.evaluate();
    const DirectionReport d = system.direction();
    system.save();
    const double h = 1e-5;
    system.apply(h);
    const double plus = system.evaluate().energy;
    system.restore();
    system.apply(-h);
    const double minus = system.evaluate().energy;
    const double error = std::abs((plus - minus) / (2 * h) - d.slope) / std::abs(d.slope);
    std::printf("%-12s step energy against its gradient: %.1e\n", kind, error);
    EXPECT_LT(error, 1e-7) << kind;
  }
}

/// The block is the second derivative of half the square, along dofs of an affine frame and at rest of a rigid one.
TEST(Inertia, BlockIsTheSecondDerivativeOfTheSquare) {
  const FrameInertia inertia{2.0, {{0.3, -0.2, 0.5}}, Mat3d::diagonal(0.7) + outer(Vec3d{{1, 2, 0}}, Vec3d{{1, 2, 0}})};
  const Mat3d Q = rotation_about(normalized(Vec3d{{1, 2, 3}}), 0.8);
  std::mt19937 random(3);
  for (const FrameKind kind : {FrameKind::rigid, FrameKind::affine}) {
    const int n = kind == FrameKind::rigid ? 6 : 12;
    std::vector<double> block(static_cast<std::size_t>(n * n)), d(static_cast<std::size_t>(n));
    add_inertia_block(kind, inertia, Q, block.data());
    for (double& v : d) v = random_vector(random, 1)[0];
    double quadratic = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) quadratic += d[at(i)] * block[at(n * i + j)] * d[at(j)];
    const double square = inertia_product(inertia, {{d[0], d[1], d[2]}}, frame_variation(kind, d.data() + 3, Q));
    EXPECT_NEAR(quadratic, square, 1e-13 * square);
  }
}

/// The moment of a torque works on the spin of A, whatever A stretches: N : ([ω]× A) = τ · ω, and nothing on stretch.
TEST(Torque, WorksOnTheSpinOfAnAffineFrame) {
  std::mt19937 random(4);
  Mat3d A = rotation_about(normalized(Vec3d{{2, -1, 1}}), 1.1);
  for (int i = 0; i < 3; ++i) A(i, i) += 0.3 * (i + 1);
  const Vec3d torque = random_vector(random, 1), spin = random_vector(random, 1);
  const Mat3d N = moment_of_torque(torque, A);
  EXPECT_NEAR(contract(N, skew(spin) * A), fascia::dot(torque, spin), 1e-13);
  const Mat3d stretch = sym(outer(random_vector(random, 1), random_vector(random, 1)));
  EXPECT_NEAR(contract(N, stretch * A), 0, 1e-13);
}

/// Constraint axes are an orthogonal change of coordinates, of vectors and blocks alike.
TEST(DofFilter, TurnsVectorsAndBlocksAlike) {
  BlockOptions o;
  o.affine = true;
  o.drilling = 0.003;
  BuiltModel built = block(o);
  const Mat3d axes = transpose(rotation_about(normalized(Vec3d{{1, 1, 2}}), 0.9));
  for (int node = 0; node < 9; ++node) {
    FrameConstraint c;
    c.node = node;
    c.translation_axes = axes;
    c.rotation_axes = rotation_about(normalized(Vec3d{{0, 1, 2}}), 0.4);
    c.translations = 1 + node % 3;
    c.rotations = node % 4;
    built.model.constraints.push_back(c);
  }
  const DofFilter filter(built.model);
  int fixed = 0;
  for (std::size_t i = 0; i < filter.size(); ++i) fixed += filter.is_fixed(i) ? 1 : 0;
  EXPECT_EQ(fixed, built.model.constrained_dof_count());
  const std::vector<double> x = random_direction(built.model);
  std::vector<double> local = x;
  filter.to_local(local);
  EXPECT_NEAR(test::norm(local), test::norm(x), 1e-12 * test::norm(x));
  std::vector<double> back = local;
  filter.to_global(back);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(back[i], x[i], 1e-14);

  std::vector<double> block(144), turned(144);
  std::mt19937 random(6);
  for (double& v : block) v = random_vector(random, 1)[0];
  filter.rotate_block(2, 20, block.data(), turned.data());
  double global_form = 0, local_form = 0;
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 12; ++j) {
      global_form += x[at(24 + i)] * block[at(12 * i + j)] * x[at(240 + j)];
      local_form += local[at(24 + i)] * turned[at(12 * i + j)] * local[at(240 + j)];
    }
  }
  EXPECT_NEAR(local_form, global_form, 1e-12 * std::abs(global_form));
}

TEST(PositiveInverse, InvertsAndStaysPositive) {
  std::mt19937 random(8);
  for (const int n : {6, 12}) {
    std::vector<double> R(at(n * n)), A(at(n * n)), inverse;
    for (double& v : R) v = random_vector(random, 1)[0];
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        for (int k = 0; k < n; ++k) A[at(n * i + j)] += R[at(n * i + k)] * R[at(n * j + k)] + (i == j ? 0.1 : 0.0);
    inverse = A;
    positive_inverse(inverse.data(), n);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        double product = 0;
        for (int k = 0; k < n; ++k) product += A[at(n * i + k)] * inverse[at(n * k + j)];
        EXPECT_NEAR(product, i == j ? 1 : 0, 1e-11);
      }
    }
    for (int i = 0; i < n; i += 2) A[at(n * i + i)] -= 20;  // indefinite
    positive_inverse(A.data(), n);
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<double> x(at(n));
      double form = 0;
      for (double& v : x) v = random_vector(random, 1)[0];
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) form += x[at(i)] * A[at(n * i + j)] * x[at(j)];
      EXPECT_GT(form, 0);
    }
  }
}

}  // namespace
}  // namespace fascia::affine_test
