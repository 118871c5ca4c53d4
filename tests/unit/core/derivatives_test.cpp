#include "tests/support/derivatives.hpp"
#include "core/executor/executor.hpp"
#include "core/solver/mechanical_system.hpp"
#include "tests/support/user_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>

namespace fascia::derivatives_test {
namespace {

using namespace test;

struct Case {
  std::string name;
  std::function<BuiltModel()> build;
  double dt = 0;
};

/// A block whose left half is rigid frames and whose right half is affine ones, tied at three places.
BuiltModel mixture() {
  BlockOptions rigid, affine;
  rigid.grid = affine.grid = {2, 3, 2};
  affine.affine = true;
  affine.drilling = 0.003;
  affine.translation = {{0.5, 0.1, 0}};
  BuiltModel built = build({block_spec(rigid), block_spec(affine)});
  PointSetBuilder points;
  Model model;
  GridBody a(block_spec(rigid), model, points), b(block_spec(affine), model, points);
  for (const Vec3d& X : {Vec3d{{0.7, 0.5, 0.5}}, Vec3d{{0.9, 0.2, 0.1}}}) {
    const Attachment at_a = a.attach(X), at_b = b.attach(X);
    std::vector<int> nodes = at_a.nodes;
    nodes.insert(nodes.end(), at_b.nodes.begin(), at_b.nodes.end());
    std::vector<Influence> influences = at_a.influences;
    influences.insert(influences.end(), at_b.influences.begin(), at_b.influences.end());
    PointSample tether{{{1e3, 0}}, X, 1, 0, 0, {}, Mat3d::diagonal(1e3) + outer(X, X) * 500.0};
    for (const Influence& i : influences) {
      Influence column;
      column.g[0] = i.w;
      for (int q = 0; q < 3; ++q) column.B(q, 0) = i.b[q];
      tether.influences.push_back(column);
    }
    points.add_points(nodes, std::span(&tether, 1), 0.5, {Law::tether, Stabilization::none, false});
  }
  // Points that follow frames of both kinds.
  const Attachment at_a = a.attach({{0.8, 0.5, 0.5}}), at_b = b.attach({{0.8, 0.5, 0.5}});
  std::vector<int> nodes = at_a.nodes;
  PointSample shared{{{5e3, 4e3}}, {{0.8, 0.5, 0.5}}, 0.1, 400, 0, {}, {}};
  for (std::size_t k = 0; k < at_a.nodes.size(); ++k) {
    Influence i = at_a.influences[k];
    i.w *= 0.5;
    i.g *= 0.5;
    i.B *= 0.5;
    shared.influences.push_back(i);
  }
  for (std::size_t k = 0; k < at_b.nodes.size(); ++k) {
    nodes.push_back(at_b.nodes[k]);
    Influence i = at_b.influences[k];
    i.w *= 0.5;
    i.g *= 0.5;
    i.B *= 0.5;
    shared.influences.push_back(i);
  }
  points.add_points(nodes, std::span(&shared, 1), 0.5);
  built.model = std::move(model);
  built.model.points = std::move(points).finish(built.model.frame_kind);
  return built;
}

/// Rigid frames and others, which bonds of the caller's own tie together.
BuiltModel bonded(bool affine_others) {
  BlockOptions rigid, affine;
  rigid.grid = affine.grid = {2, 3, 2};
  affine.affine = affine_others;
  if (affine_others) affine.drilling = 0.003;
  affine.translation = {{0.5, 0.1, 0}};
  BuiltModel built;
  PointSetBuilder points;
  built.bodies.emplace_back(block_spec(rigid), built.model, points);
  built.bodies.emplace_back(block_spec(affine), built.model, points);
  const int of_rigid = 12, nodes = built.model.node_count();
  std::vector<Bonds::Bond> bonds;
  for (int a = 0; a < of_rigid; a += 2)
    for (const int b : {of_rigid + a, nodes - 1 - a})
      bonds.push_back({{a, b}, {{{0.1, 0.02 * a, 0.3}}, {{-0.2, 0.1, 0.01 * b}}}});
  bonds.push_back({{3, 1}, {{{0.1, 0.2, 0.3}}, {{-0.2, 0.1, 0.4}}}});
  points.add_user_block(std::make_shared<Bonds>(bonds, 2e4, 0.5));
  built.model.points = std::move(points).finish(built.model.frame_kind);
  return built;
}

/// Every kind of term: drilling or not, both blends, selective points, viscosity, affine frames, thin laws, tethers.
std::vector<Case> cases() {
  BlockOptions plain;
  plain.grid = {3, 3, 2};
  BlockOptions no_drilling = plain, full = plain, linear = plain, selective = plain, viscous = plain, affine = plain;
  no_drilling.drilling = 0;
  full.half_blend = false;
  full.drilling = 0;
  linear.weights = GridWeightKind::linear;
  selective.grid = {3, 3, 3};
  selective.poisson = 0.48;
  viscous.stiffness_damping = 0.02;
  affine.affine = true;
  affine.drilling = 0.003;
  const auto of_law = [](Law law, BlockOptions o) {
    o.law = law;
    return o;
  };
  BlockOptions turned = plain, affine_viscous = affine, fading = plain, fading_affine = affine,
               fading_selective = selective, acting = plain, acting_affine = affine, acting_fading = plain;
  fading.viscosity = fading_affine.viscosity = two_branches();
  fading_selective.viscosity = two_branches(true);
  acting.active = acting_affine.active = acting_fading.active = askew_muscle(3e3);
  acting_fading.viscosity = two_branches();
  turned.rotation = rotation_about(normalized(Vec3d{{1, 2, 3}}), 0.7);
  affine_viscous.stiffness_damping = 0.02;
  const auto solid = [](const BlockOptions& o) { return [o] { return block(o); }; };
  const auto thin = [](const std::vector<int>& grid, const BlockOptions& o) {
    return [grid, o] { return build_cloud(thin_spec(grid, o)); };
  };
  return {{"default", solid(plain)},
          {"no drilling", solid(no_drilling)},
          {"paper", solid(full)},
          {"linear", solid(linear)},
          {"selective", solid(selective)},
          {"neo hookean", solid(of_law(Law::neo_hookean, plain))},
          {"mooney rivlin", solid(of_law(Law::mooney_rivlin, plain))},
          {"selective mooney rivlin", solid(of_law(Law::mooney_rivlin, selective))},
          {"affine viscous mooney rivlin", solid(of_law(Law::mooney_rivlin, affine_viscous)), 0.05},
          {"viscous", solid(viscous), 0.05},
          {"affine", solid(affine)},
          {"affine viscous", solid(affine_viscous), 0.05},
          {"sheet", thin({4, 3}, turned)},
          {"line", thin({5}, turned)},
          {"viscous line", thin({5}, viscous), 0.05},
          {"affine sheet", thin({4, 3}, affine)},
          {"affine line", thin({5}, affine)},
          {"scattered", [plain] { return build_cloud(scattered_spec(plain, 0.4, 1)); }},
          {"fading", solid(fading)},
          {"fading mooney rivlin", solid(of_law(Law::mooney_rivlin, fading))},
          {"fading selective neo hookean", solid(of_law(Law::neo_hookean, fading_selective))},
          {"fading affine", solid(fading_affine)},
          {"fading sheet", thin({4, 3}, fading)},
          {"fading line", thin({5}, fading)},
          {"acting", solid(acting)},
          {"acting neo hookean", solid(of_law(Law::neo_hookean, acting))},
          {"acting and fading", solid(acting_fading)},
          {"acting affine", solid(acting_affine)},
          {"acting sheet", thin({4, 3}, acting)},
          {"acting line", thin({5}, acting)},
          {"mixture", mixture},
          {"bonded", [] { return bonded(false); }},
          {"bonded to affine", [] { return bonded(true); }}};
}

class Derivatives : public DerivativeTest<Case, BuiltModel> {
 protected:
  Derivatives() : DerivativeTest(GetParam().build(), 0.02, 0.4) {}
};

TEST_P(Derivatives, GradientIsThatOfTheEnergy) { expect_gradient_of_the_energy(); }

TEST_P(Derivatives, TangentIsTheSecondDerivativeAlongExponentials) { expect_second_derivative_along_exponentials(); }

TEST_P(Derivatives, DifferencesOfTheGradientAreTangentMinusHalfTorque) {
  expect_differences_to_be_tangent_minus_half_torque();
}

TEST_P(Derivatives, AssembledMatrixEqualsTheProduct) { expect_assembled_equals_product(); }

TEST_P(Derivatives, ExtrapolatedStressesAreOfSecondOrder) { expect_extrapolation_of_second_order(); }

TEST_P(Derivatives, MaterialTangentIsSymmetricAndNotNegative) { expect_symmetric_and_not_negative(); }

INSTANTIATE_TEST_SUITE_P(Terms, Derivatives, testing::ValuesIn(cases()), [](const auto& parameter) {
  std::string name = parameter.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

/// A turn to first order stretches a body by the square of its angle. That stress is not in an extrapolated tangent,
/// which has no geometric part then.
TEST(ExtrapolatedTangent, HasNoStressAfterATurnOfFirstOrder) {
  const BuiltModel built = block();
  ThreadPool pool(1);
  CpuExecutor executor(built.model.points, pool);
  const State rest = State::at_rest(built.model);
  TakenStep turn{rest.u, rest.D, std::vector<double>(at(built.model.dof_count()), 0.0)};
  const Vec3d angle{{0.1, 0.4, -0.3}};
  for (int node = 0; node < built.model.node_count(); ++node) {
    double* d = turn.d.data() + built.model.points.dofs.begin(node);
    const Vec3d u = cross(angle, built.model.rest_position[at(node)]);
    for (int k = 0; k < 3; ++k) {
      d[k] = u[k];
      d[3 + k] = angle[k];
    }
  }
  const State end = moved(built.model, rest, turn.d, 1);
  std::vector<double> unused(turn.d.size()), material = unused, extrapolated = unused, plain = unused;
  executor.gradient(end, {}, unused);
  const std::vector<double> d = random_direction(built.model);
  Linearization lin;
  executor.linearize(end, {}, Tangent::material, lin);
  executor.multiply(lin, d, material);
  executor.linearize(end, {}, Tangent::full, lin);
  executor.multiply(lin, d, plain);
  executor.linearize(end, {}, Tangent::full, lin, true, &turn);
  executor.multiply(lin, d, extrapolated);
  const auto distance = [&](std::vector<double> a) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] -= material[i];
    return norm(a) / norm(material);
  };
  std::printf("geometric part after a turn by 0.51 rad: %.1e of the material part, extrapolated %.1e\n",
              distance(plain), distance(extrapolated));
  EXPECT_GT(distance(plain), 0.01);
  EXPECT_LT(distance(extrapolated), 1e-14);
}

/// The slow reference: F of one point from the formula, against differences and against the executor's strain energy.
TEST(Reference, DeformationGradientAgainstDifferences) {
  const BuiltModel built = block();
  const ModelBody& body = built.bodies[0];
  const State state = random_state(built.model, 0.05, 0.4);
  const auto position = [&](const Vec3d& X) {
    const Attachment a = body.attach(X);
    Vec3d x = X;
    for (std::size_t k = 0; k < a.nodes.size(); ++k)
      x += state.u[static_cast<std::size_t>(a.nodes[k])] * a.influences[k].w +
           state.D[static_cast<std::size_t>(a.nodes[k])] * a.influences[k].b;
    return x;
  };
  double largest = 0;
  for (std::size_t q = 0; q < body.points().size(); ++q) {
    const BodyPoint& p = body.points()[q];
    const Attachment a = body.attach_point(q);
    Mat3d F = Mat3d::identity();
    for (std::size_t k = 0; k < a.nodes.size(); ++k)
      F += outer(state.u[static_cast<std::size_t>(a.nodes[k])], a.influences[k].g) +
           state.D[static_cast<std::size_t>(a.nodes[k])] * a.influences[k].B;
    for (int j = 0; j < 3; ++j) {
      Vec3d e;
      e[j] = 1e-5;
      const Vec3d column = (position(p.X + e) - position(p.X - e)) * (0.5 / 1e-5);
      for (int i = 0; i < 3; ++i) largest = std::max(largest, std::abs(column[i] - F(i, j)));
    }
  }
  std::printf("F against differences of the position: %.1e\n", largest);
  EXPECT_LT(largest, 1e-9);
}

TEST(Reference, EnergyAndForcesFromPlainLoops) {
  BlockOptions o;
  const BuiltModel built = block(o);
  const ModelBody& body = built.bodies[0];
  const State state = random_state(built.model, 0.05, 0.4);
  double elastic = 0, drilling = 0;
  std::vector<Vec3d> force(state.u.size()), torque(state.u.size());
  for (std::size_t q = 0; q < body.points().size(); ++q) {
    const BodyPoint& p = body.points()[q];
    const Attachment a = body.attach_point(q);
    Mat3d F = Mat3d::identity(), Qbar;
    for (std::size_t k = 0; k < a.nodes.size(); ++k) {
      const auto node = static_cast<std::size_t>(a.nodes[k]);
      F += outer(state.u[node], a.influences[k].g) + state.D[node] * a.influences[k].B;
      Qbar += (Mat3d::identity() + state.D[node]) * a.influences[k].w;
    }
    const Mat3d E = (transpose_times(F, F) - Mat3d::identity()) * 0.5;
    const Mat3d S = Mat3d::diagonal(p.lambda * trace(E)) + E * (2 * p.mu);
    const double gamma = o.drilling * p.mu;
    const Mat3d M = transpose_times(Qbar, F), T = (M - transpose(M)) * gamma;
    elastic += p.volume * 0.5 * contract(S, E);
    drilling += p.volume / (4 * gamma) * contract(T, T);
    const Mat3d P = F * S + Qbar * T, Y = times_transpose(F, T);
    for (std::size_t k = 0; k < a.nodes.size(); ++k) {
      const auto node = static_cast<std::size_t>(a.nodes[k]);
      const Mat3d Q = Mat3d::identity() + state.D[node];
      force[node] += P * a.influences[k].g * p.volume;
      torque[node] +=
          (axl(times_transpose(Q * a.influences[k].B, P)) + axl(times_transpose(Q, Y)) * a.influences[k].w) * p.volume;
    }
  }
  ThreadPool pool(1);
  CpuExecutor executor(built.model.points, pool);
  std::vector<double> g(static_cast<std::size_t>(built.model.dof_count()));
  const InternalEnergy energy = executor.gradient(state, {}, g);
  EXPECT_NEAR(energy.elastic, elastic, 1e-12 * elastic);
  EXPECT_NEAR(energy.stabilization, drilling, 1e-12 * drilling);
  const double scale = test::norm(g);
  for (std::size_t i = 0; i < force.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(g[6 * i + k], force[i][static_cast<int>(k)], 1e-12 * scale);
      EXPECT_NEAR(g[6 * i + 3 + k], torque[i][static_cast<int>(k)], 1e-12 * scale);
    }
}

}  // namespace
}  // namespace fascia::derivatives_test
