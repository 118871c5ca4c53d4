#include "core/executor/executor.hpp"
#include "core/solver/mechanical_system.hpp"
#include "fem/quadrature.hpp"
#include "tests/support/fading.hpp"
#include "tests/support/statics.hpp"
#include "tests/unit/fem/element_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <numeric>

namespace fascia::element_body_test {
namespace {

using namespace test;

constexpr ElementShape kShapes[] = {ElementShape::tet4, ElementShape::tet10, ElementShape::hex8, ElementShape::hex20};

TEST(ElementBody, MassAndWeightAddUp) {
  for (const ElementShape shape : kShapes) {
    ElementOptions o;
    o.shape = shape;
    const ElementModel built = element_model(o);
    double mass = 0;
    for (const FrameInertia& i : built.model.inertia) {
      EXPECT_GT(i.mass, 0);
      mass += i.mass;
    }
    EXPECT_NEAR(mass, built.body->mass(), 1e-13 * mass);
    const std::vector<double>& weights = built.body->weights();
    EXPECT_EQ(weights.empty(), order_of(shape) == 1);
    if (weights.empty()) continue;
    EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), mass, 1e-13 * mass);
  }
}

/// Irregular elements under u = A X on the boundary: inner nodes find it, every point strains alike.
TEST(ElementBody, PatchTest) {
  const Mat3d A = Mat3d::from_columns({{0.12, 0.03, -0.05}}, {{0.08, -0.1, 0.02}}, {{-0.04, 0.06, 0.09}});
  for (const ElementShape shape : kShapes) {
    for (const auto formulation :
         {ElementFormulation::linear, ElementFormulation::corotational, ElementFormulation::large_strain}) {
      ElementOptions o;
      o.shape = shape;
      o.formulation = formulation;
      o.cells = {3, 3, 3};
      ElementModel built = element_model(o, [&] {
        ElementOptions straight = o;  // straight edges: curved ones hold no linear field's equilibrium exactly
        straight.shape = element_shape(family_of(shape), 1);
        const ElementMesh mesh = distorted_mesh(straight);
        return order_of(shape) == 2 ? quadratic(mesh) : mesh;
      }());
      State state = State::at_rest(built.model);
      const std::vector<char> boundary = built.body->nodes_on_boundary();
      for (int i = 0; i < built.model.node_count(); ++i) {
        if (boundary[at(i)] == 0) continue;
        state.u[at(i)] = A * built.model.rest_position[at(i)];
        FrameConstraint c;
        c.node = i;
        c.translations = 3;
        c.translation_motion = {0, 0, 0};
        built.model.constraints.push_back(c);
      }
      // Held where they are put: the motion of each is zero from there on.
      for (FrameConstraint& c : built.model.constraints) c.translation_motion = {-1, -1, -1};
      ThreadPool pool(1);
      CpuExecutor executor(built.model.points, pool);
      std::vector<double> g(at(built.model.dof_count()));
      for (int i = 0; i < built.model.node_count(); ++i) state.u[at(i)] = A * built.model.rest_position[at(i)];
      executor.gradient(state, {}, g);
      double inner = 0, outer = 0;
      for (int i = 0; i < built.model.node_count(); ++i)
        for (int k = 0; k < 3; ++k) {
          double& largest = boundary[at(i)] != 0 ? outer : inner;
          largest = std::max(largest, std::abs(g[at(3 * i + k)]));
        }
      EXPECT_LT(inner, 1e-12 * outer);
      const std::vector<PointTensors> tensors = built.body->tensors(state);
      for (const PointTensors& t : tensors)
        EXPECT_LT(norm(t.stress - tensors[0].stress), 1e-12 * norm(tensors[0].stress));
    }
  }
}

/// Shape functions of a rule are those at its points, and gradients there those of the attachments.
TEST(ElementBody, GradientsAreThoseOfAttachments) {
  for (const ElementShape shape : kShapes) {
    for (const QuadraturePoint& q : quadrature(shape)) {
      EXPECT_EQ(q.N, shape_values(shape, q.xi));
      EXPECT_EQ(q.dN, shape_gradients(shape, q.xi));
    }
    ElementOptions o;
    o.shape = shape;
    const ElementModel built = element_model(o, distorted_mesh(o));
    const State state = random_state(built.model, 0.03, 0);
    const std::vector<Mat3d> H = built.body->gradients(state);
    ASSERT_EQ(H.size(), built.body->points().size());
    for (std::size_t q = 0; q < H.size(); ++q)
      EXPECT_LT(norm(H[q] - field_at(built.body->attach_point(q), state).H), 1e-13 * norm(H[q]));
  }
}

TEST(ElementBody, NumberingDoesNotMatter) {
  for (const ElementShape shape : kShapes) {
    ElementOptions o;
    o.shape = shape;
    const ElementMesh mesh = distorted_mesh(o);
    ElementMesh other = mesh;
    const auto n = mesh.nodes.size(), m = mesh.size(), per = mesh.element(0).size();
    for (std::size_t i = 0; i < n; ++i) other.nodes[n - 1 - i] = mesh.nodes[i];
    for (std::size_t e = 0; e < m; ++e)
      for (std::size_t a = 0; a < per; ++a)
        other.element_nodes[(m - 1 - e) * per + a] = static_cast<int>(n) - 1 - mesh.element(e)[a];
    const ElementModel first = element_model(o, mesh), second = element_model(o, other);
    State state = random_state(first.model, 0.03, 0), reversed = state;
    std::reverse(reversed.u.begin(), reversed.u.end());
    ThreadPool pool(1);
    CpuExecutor a(first.model.points, pool), b(second.model.points, pool);
    std::vector<double> f(3 * n), g(3 * n);
    const double energy = a.gradient(state, {}, f).total();
    EXPECT_NEAR(b.gradient(reversed, {}, g).total(), energy, 1e-13 * energy);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(f[3 * i + k], g[3 * (n - 1 - i) + k], 1e-13 * test::norm(f));
  }
}

TEST(ElementBody, ThreadsDoNotMatter) {
  ElementOptions o;
  o.cells = {12, 10, 8};
  o.locking = ElementLocking::averaged;
  const ElementModel built = element_model(o);
  const State state = random_state(built.model, 0.005, 0);
  std::vector<double> first, matrix;
  for (const int threads : {1, 2, 5}) {
    ThreadPool pool(threads);
    CpuExecutor executor(built.model.points, pool);
    std::vector<double> g(at(built.model.dof_count()));
    executor.gradient(state, {}, g);
    Linearization lin;
    executor.linearize(state, {}, Tangent::full, lin);
    BlockMatrix K(built.model.points);
    executor.assemble(lin, K);
    const std::vector<double> values(K.values(), K.values() + K.value_count());
    if (threads == 1) {
      first = g;
      matrix = values;
    }
    EXPECT_EQ(g, first);
    EXPECT_EQ(values, matrix);
  }
}

/// Relative difference between the elastic energy of the mechanics and energy densities times volumes.
double energy_gap(const ElementModel& built) {
  const State state = random_state(built.model, 0.02, 0);
  double sum = 0;
  const std::vector<PointTensors> tensors = built.body->tensors(state);
  for (std::size_t q = 0; q < tensors.size(); ++q) sum += tensors[q].energy_density * built.body->points()[q].volume;
  ThreadPool pool(1);
  CpuExecutor executor(built.model.points, pool);
  std::vector<double> g(at(built.model.dof_count()));
  const double energy = executor.gradient(state, {}, g).elastic;
  return std::abs(sum - energy) / energy;
}

TEST(ElementBody, TensorsAddUpToTheEnergy) {
  for (const ElementShape shape : kShapes) {
    for (int kind = 0; kind < 4; ++kind) {
      ElementOptions o;
      o.shape = shape;
      o.formulation = kind == 0   ? ElementFormulation::linear
                      : kind == 1 ? ElementFormulation::corotational
                                  : ElementFormulation::large_strain;
      o.law = kind == 3 ? Law::neo_hookean : Law::st_venant_kirchhoff;
      o.penalty = family_of(shape) == ElementFamily::tetrahedra ? 1e5 : 0;
      EXPECT_LT(energy_gap(element_model(o)), 1e-12);
    }
  }
}

/// The same of averaged elements of both laws in one body, soft beside stiff.
TEST(ElementBody, TensorsOfAveragedElementsAddUpToTheEnergy) {
  ElementBodySpec spec;
  spec.mesh = distorted_mesh({});
  spec.locking = ElementLocking::averaged;
  spec.penalty = 1e5;
  spec.density = 1000;
  spec.material = [](const Vec3d&, int element) {
    return PointMaterialSpec{
        {{element % 3 == 0 ? 1e6 : 2e4, 4e3}}, 0, 0, element % 2 == 0 ? Law::neo_hookean : Law::st_venant_kirchhoff};
  };
  EXPECT_LT(energy_gap(element_model(std::move(spec))), 1e-12);
}

TEST(ElementBody, ATensorFieldIsWhatTensorsAreAtEachPlace) {
  for (const ElementLocking locking : {ElementLocking::none, ElementLocking::averaged}) {
    ElementOptions o;
    o.locking = locking;
    const ElementModel built = element_model(o);
    const State state = random_state(built.model, 0.02, 0);
    const std::vector<PointTensors> tensors = built.body->tensors(state);
    const TensorField field = built.body->tensor_field(state);
    for (std::size_t q = 0; q < tensors.size(); q += 7) {
      const Attachment place = built.body->attach_point(q);
      EXPECT_LE(norm(field(place, q).stress - tensors[q].stress), 1e-14 * norm(tensors[q].stress));
      EXPECT_EQ(norm(field(place, q).stress - built.body->tensors_at(place, q, state).stress), 0);
    }
  }
}

/// Where nothing has faded yet, stresses are those of the law at any place of an element, whatever the formulation.
TEST(FadingStresses, AreThoseOfTheLawWhileNothingHasFaded) {
  for (const auto formulation :
       {ElementFormulation::linear, ElementFormulation::corotational, ElementFormulation::large_strain})
    for (const bool shear_only : {false, true}) {
      std::vector<Mat3d> found[2];
      for (const bool fades : {false, true}) {
        ElementOptions o;
        o.shape = ElementShape::hex20;
        o.formulation = formulation;
        Viscosity at_once = *two_branches(shear_only);
        at_once.instantaneous_statics = true;
        if (fades) o.viscosity = std::make_shared<const Viscosity>(at_once);
        ElementModel built = element_model(o);
        built.body->find_memories(built.model.points);
        ThreadPool pool(1);
        MechanicalSystem system(built.model, pool, {});
        State end = random_state(built.model, 0.02, 0);
        end.memory.resize(built.model.points.memory.size());
        if (fades) {
          StressMemory<PoolSpace> memory(built.model.points.memory);
          std::vector<double> relaxing(memory.relaxing(), memory.relaxing() + memory.given_size());
          AlignedVector<double> given(relaxing.begin(), relaxing.end()), S(memory.stress_size());
          system.executor().store_stress(end, given, S);
          memory.prepare(Fading::over(0));
          memory.keep(end.memory.data(), S.data());
        }
        for (const Vec3d& X : {Vec3d{{0.1, 0.7, 0.1}}, Vec3d{{0.8, 0.3, 0.4}}, Vec3d{{0.5, 0.4, 0.25}}})
          found[fades ? 1 : 0].push_back(built.body->tensors_at(built.body->attach(X), 0, end).stress);
      }
      for (std::size_t k = 0; k < found[0].size(); ++k)
        EXPECT_LT(norm(found[0][k] - found[1][k]), 1e-10 * norm(found[0][k])) << static_cast<int>(formulation);
    }
}

/// A tangent that nothing changes stands for that of any state; a frame that turns changes it.
TEST(LinearModels, AreThoseOfTheLinearLawAlone) {
  ElementOptions o;
  for (const auto formulation :
       {ElementFormulation::linear, ElementFormulation::corotational, ElementFormulation::large_strain}) {
    o.formulation = formulation;
    EXPECT_EQ(element_model(o).model.is_linear(), formulation == ElementFormulation::linear);
  }
  o.formulation = ElementFormulation::linear;
  Model with_frame = element_model(o).model;
  with_frame.frame_kind.back() = FrameKind::rigid;
  EXPECT_FALSE(with_frame.is_linear());
  Model with_spring = element_model(o).model;
  with_spring.points.springs.emplace_back();
  EXPECT_FALSE(with_spring.is_linear());
  EXPECT_FALSE(block().model.is_linear()) << "a meshless body";
}

/// Of conjugate gradients as of a factor, as far as Newton's tolerance goes.
TEST(ElementBody, OneDirectionSolvesALinearModel) {
  for (const ElementShape shape : kShapes) {
    ElementOptions o;
    o.shape = shape;
    o.formulation = ElementFormulation::linear;
    o.cells = {8, 3, 2};
    ElementModel built =
        element_model(o, generate_box({}, {{1, 0.4, 0.25}}, o.cells, {family_of(shape), order_of(shape), 6}));
    hold_face(built.model);
    add_gravity(built.model, {{0, 0, -9.81}});
    SolverSettings settings;
    settings.linear = LinearMethod::cholesky;
    const Solved exact = solved(built.model, settings);
    settings.linear = LinearMethod::cg;
    const Solved iterated = solved(built.model, settings);
    for (const Solved& s : {exact, iterated}) {
      EXPECT_EQ(s.run.newton_iterations, 1) << s.run.residual;
      EXPECT_LE(s.run.residual, settings.tolerance);
      EXPECT_TRUE(s.run.stability.known);
      EXPECT_EQ(s.run.stability.unstable, 0);
    }
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < exact.end.u.size(); ++i) {
      difference = std::max(difference, norm(iterated.end.u[i] - exact.end.u[i]));
      size = std::max(size, norm(exact.end.u[i]));
    }
    EXPECT_LE(difference, 1e-8 * size);
  }
}

}  // namespace
}  // namespace fascia::element_body_test
