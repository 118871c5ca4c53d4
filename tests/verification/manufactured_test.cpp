// Finite elements against manufactured solutions: order of convergence of the displacement.
#include "core/run/drivers.hpp"
#include "fem/quadrature.hpp"
#include "tests/support/cases.hpp"
#include "tests/unit/fem/element_models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace fascia::manufactured_test {
namespace {

using namespace test;

enum class ElasticLaw { linear, corotational, st_venant_kirchhoff, neo_hookean };
enum class Mesh { regular, mapped, random };

const char* const kLawNames[] = {"linear", "co-rotational", "St Venant-Kirchhoff", "neo-Hookean"};
const char* const kShapeNames[] = {"4-node tetrahedra", "10-node tetrahedra", "8-node hexahedra", "20-node hexahedra"};
const char* const kMeshNames[] = {"regular", "mapped", "random"};

/// What is solved: a law on elements, with the amplitude of the field.
struct Problem {
  ElementShape shape = ElementShape::tet4;
  Mesh mesh = Mesh::mapped;
  ElasticLaw law = ElasticLaw::st_venant_kirchhoff;
  double amplitude = 0.03;  ///< [m]
  double poisson = 0.3;
  ElementLocking locking = ElementLocking::none;
};

constexpr double kYoung = 1e4;

/// u_i = a sin(k_i · X + p_i), waves longer than the body. With a = 30 mm strains and rotations reach 0.08.
struct Field {
  double a;

  static Vec3d wave(int i) {
    constexpr std::array<Vec3d, 3> k{{{{2, 1.5, -1}}, {{-1, 2, 1.5}}, {{1.5, -1, 2}}}};
    return k[at(i)];
  }
  static double phase(int i, const Vec3d& X) { return dot(wave(i), X) + 0.4 + 0.7 * i; }

  Vec3d u(const Vec3d& X) const {
    return {{a * std::sin(phase(0, X)), a * std::sin(phase(1, X)), a * std::sin(phase(2, X))}};
  }
  /// du_i/dX_j
  Mat3d gradient(const Vec3d& X) const {
    Mat3d H;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) H(i, j) = a * std::cos(phase(i, X)) * wave(i)[j];
    return H;
  }
};

/// R of F = R U by Newton's iteration (Higham 1986).
Mat3d rotation_of(const Mat3d& F) {
  Mat3d R = F;
  for (int k = 0; k < 8; ++k) R = (R + transpose(inverse(R))) * 0.5;
  return R;
}

/// First Piola-Kirchhoff stress of a law, written independently of the program's [Pa].
Mat3d first_piola(const Problem& problem, const Mat3d& H) {
  const double nu = problem.poisson, mu = kYoung / (2 * (1 + nu)), lambda = 2 * mu * nu / (1 - 2 * nu);
  const auto hooke = [&](const Mat3d& e) { return e * (2 * mu) + Mat3d::diagonal(lambda * trace(e)); };
  const Mat3d I = Mat3d::identity(), F = I + H;
  switch (problem.law) {
    case ElasticLaw::linear:
      return hooke(sym(H));
    case ElasticLaw::corotational: {
      const Mat3d R = rotation_of(F);
      return R * hooke(sym(transpose_times(R, F)) - I);
    }
    case ElasticLaw::st_venant_kirchhoff:
      return F * hooke((transpose_times(F, F) - I) * 0.5);
    case ElasticLaw::neo_hookean: {
      const Mat3d T = transpose(inverse(F));
      return (F - T) * mu + T * (lambda * std::log(determinant(F)));
    }
  }
  return {};
}

/// b = −div P [N/m³], by differences of sixth order: exact to about 1e-11 of its size for waves of metres.
Vec3d body_force(const Problem& problem, const Vec3d& X) {
  constexpr double step = 0.01;
  constexpr std::array<double, 3> weight{45.0 / 60, -9.0 / 60, 1.0 / 60};
  const Field field{problem.amplitude};
  Vec3d b;
  for (int j = 0; j < 3; ++j)
    for (int k = 1; k <= 3; ++k) {
      Vec3d offset;
      offset[j] = k * step;
      const Mat3d ahead = first_piola(problem, field.gradient(X + offset)),
                  behind = first_piola(problem, field.gradient(X - offset));
      b -= (ahead - behind).column(j) * (weight[at(k - 1)] / step);
    }
  return b;
}

/// Points of Gauss along each axis; tetrahedra as collapsed cubes. Finer than the element's own rule.
std::vector<QuadraturePoint> fine_rule(ElementShape shape) {
  constexpr double x3 = 0.774596669241483377, x4 = 0.861136311594052575, y4 = 0.339981043584856265;
  constexpr double w4 = 0.347854845137453857;
  using Line = std::vector<std::array<double, 2>>;
  const Line line = order_of(shape) == 1 ? Line{{-x3, 5.0 / 9}, {0, 8.0 / 9}, {x3, 5.0 / 9}}
                                         : Line{{-x4, w4}, {-y4, 1 - w4}, {y4, 1 - w4}, {x4, w4}};
  std::vector<QuadraturePoint> points;
  for (const auto& [x, wx] : line)
    for (const auto& [y, wy] : line)
      for (const auto& [z, wz] : line) {
        QuadraturePoint q{{{x, y, z}}, wx * wy * wz};
        if (family_of(shape) == ElementFamily::tetrahedra) {
          const double r = (1 + x) / 2, s = (1 + y) / 2, t = (1 + z) / 2;
          q = {{{r * (1 - s) * (1 - t), s * (1 - t), t}}, q.weight / 8 * (1 - s) * (1 - t) * (1 - t)};
        }
        points.push_back(q);
      }
  return points;
}

/// A unit cube of n cells along each axis, edges straight: mapped smoothly, or with each node moved at random by up to
/// a tenth of the spacing.
ElementMesh mesh_of(ElementShape shape, Mesh kind, int n) {
  const ElementFamily family = family_of(shape);
  ElementMesh mesh = generate_box({}, {{1, 1, 1}}, {n, n, n}, {family, 1, 6});
  std::mt19937 random(7);
  for (Vec3d& X : mesh.nodes) {
    if (kind == Mesh::mapped) {
      const auto s = [&](int k) { return std::sin(std::numbers::pi * X[k]); };
      X += Vec3d{{0.06 * s(1) + 0.04 * s(2), 0.06 * s(2) - 0.04 * s(0), 0.06 * s(0) + 0.04 * s(1)}};
    } else if (kind == Mesh::random) {
      X += random_vector(random, 0.1 / n);
    }
  }
  return order_of(shape) == 2 ? quadratic(mesh) : mesh;
}

/// Calls act(element, place, volume [m³]) at each point of the fine rule.
template <class Act>
void integrate(const ElementMesh& mesh, const Act& act) {
  const std::vector<QuadraturePoint> rule = fine_rule(mesh.shape);
  for (std::size_t e = 0; e < mesh.size(); ++e)
    for (const QuadraturePoint& q : rule) {
      const ElementPoint p = shape_at(mesh, e, q.xi);
      act(mesh.element(e), p, q.weight * p.det_J);
    }
}

/// Prescribes u on the boundary and the consistent forces Σ v N b inside.
void load(ElementModel& built, const ElementMesh& mesh, const Problem& problem) {
  const Field field{problem.amplitude};
  Model& model = built.model;
  const std::vector<char> boundary = built.body->nodes_on_boundary();
  DeadLoad dead;
  for (int i = 0; i < model.node_count(); ++i) {
    dead.nodes.push_back({i, {}, {}, {}});
    if (boundary[at(i)] == 0) continue;
    PrescribedMotion motion;
    motion.translation = field.u(model.rest_position[at(i)]);
    const int number = static_cast<int>(model.motions.size());
    model.motions.push_back(motion);
    FrameConstraint held;
    held.node = i;
    held.translations = 3;
    held.translation_motion = {number, number, number};
    model.constraints.push_back(held);
  }
  integrate(mesh, [&](std::span<const int> nodes, const ElementPoint& p, double volume) {
    const Vec3d f = body_force(problem, p.X) * volume;
    for (std::size_t a = 0; a < nodes.size(); ++a) dead.nodes[at(nodes[a])].force += f * p.N[a];
  });
  model.loads.push_back(dead);
}

/// ‖u_h − u‖ / ‖u‖ in L².
double displacement_error(const ElementMesh& mesh, const State& state, const Field& field) {
  double difference = 0, size = 0;
  integrate(mesh, [&](std::span<const int> nodes, const ElementPoint& p, double volume) {
    const Vec3d u = field.u(p.X);
    Vec3d u_h;
    for (std::size_t a = 0; a < nodes.size(); ++a) u_h += state.u[at(nodes[a])] * p.N[a];
    difference += volume * dot(u_h - u, u_h - u);
    size += volume * dot(u, u);
  });
  return std::sqrt(difference / size);
}

/// The relative error on a mesh of n cells along each axis.
double solve(const Problem& problem, int n) {
  ElementOptions o;
  o.shape = problem.shape;
  o.young = kYoung;
  o.poisson = problem.poisson;
  o.locking = problem.locking;
  o.law = problem.law == ElasticLaw::neo_hookean ? Law::neo_hookean : Law::st_venant_kirchhoff;
  o.formulation = problem.law == ElasticLaw::linear         ? ElementFormulation::linear
                  : problem.law == ElasticLaw::corotational ? ElementFormulation::corotational
                                                            : ElementFormulation::large_strain;
  const ElementMesh mesh = mesh_of(problem.shape, problem.mesh, n);
  ElementModel built = element_model(o, mesh);
  load(built, mesh, problem);
  ThreadPool pool(1);
  const SolverSettings settings;
  MechanicalSystem system(built.model, pool, settings);
  State state = State::at_rest(built.model);
  const RunReport report = run_statics(system, state, kRamp, settings, {}, nullptr);
  EXPECT_EQ(report.status, RunStatus::converged) << report.message;
  return displacement_error(mesh, state, {problem.amplitude});
}

void print_header() {
  std::printf("%-18s  %-19s  %-7s  a [m]  cells, relative L2 error, order\n", "elements", "law", "mesh");
}

/// The order between the last two of the meshes; prints a row.
double order(const Problem& problem, const std::vector<int>& cells) {
  std::printf("%-18s  %-19s  %-7s  %5.0e", kShapeNames[static_cast<int>(problem.shape)],
              kLawNames[static_cast<int>(problem.law)], kMeshNames[static_cast<int>(problem.mesh)], problem.amplitude);
  double previous = 0, result = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double error = solve(problem, cells[i]);
    std::printf("  %2d %.3e", cells[i], error);
    if (i > 0) {
      result = std::log(previous / error) / std::log(static_cast<double>(cells[i]) / cells[i - 1]);
      std::printf(" %5.2f", result);
    }
    previous = error;
  }
  std::printf("\n");
  return result;
}

constexpr ElementShape kLinear[] = {ElementShape::tet4, ElementShape::hex8};
constexpr ElementShape kQuadratic[] = {ElementShape::tet10, ElementShape::hex20};

/// A mapped mesh has all that a regular one has: there one law will do, unless tests run in full size.
bool shows_something_new(Mesh mesh, ElasticLaw law) {
  return mesh != Mesh::regular || law == ElasticLaw::st_venant_kirchhoff || test::full_size();
}

// Theory: order 2 of linear and 3 of quadratic elements; coarse meshes miss it by a few hundredths.
TEST(Manufactured, LinearElementsAreOfSecondOrder) {
  print_header();
  for (const ElementShape shape : kLinear)
    for (const Mesh mesh : {Mesh::regular, Mesh::mapped})
      for (const ElasticLaw law :
           {ElasticLaw::linear, ElasticLaw::corotational, ElasticLaw::st_venant_kirchhoff, ElasticLaw::neo_hookean})
        if (shows_something_new(mesh, law)) {
          EXPECT_GT(order({shape, mesh, law}, {4, 8}), 1.9);
        }
}

/// Cells along an edge from which on quadratic elements show their order: two mirrored cells of tetrahedra are too few.
std::vector<int> coarse(ElementShape shape) {
  return shape == ElementShape::tet10 ? std::vector<int>{3, 6} : std::vector<int>{2, 4};
}

TEST(Manufactured, QuadraticElementsAreOfThirdOrder) {
  print_header();
  for (const ElementShape shape : kQuadratic)
    for (const Mesh mesh : {Mesh::regular, Mesh::mapped})
      for (const ElasticLaw law : {ElasticLaw::linear, ElasticLaw::st_venant_kirchhoff, ElasticLaw::neo_hookean})
        if (shows_something_new(mesh, law)) {
          EXPECT_GT(order({shape, mesh, law}, coarse(shape)), 2.8);
        }
}

TEST(Manufactured, OrdersHoldOnIrregularMeshes) {
  print_header();
  for (const ElementShape shape : kLinear) EXPECT_GT(order({shape, Mesh::random}, {4, 8}), 1.9);
  for (const ElementShape shape : kQuadratic) EXPECT_GT(order({shape, Mesh::random}, coarse(shape)), 2.8);
}

TEST(Manufactured, OrdersHoldOnFinerMeshes) {
  print_header();
  for (const ElementShape shape : kLinear) EXPECT_GT(order({shape}, {8, 12}), 1.95);
  for (const ElementShape shape : kQuadratic) EXPECT_GT(order({shape}, {4, 6}), 2.9);
}

/// A quadratic element turns as a whole, while the material turns differently from place to place in it: that leaves a
/// strain of the square of the difference, which is of second order in the spacing.
TEST(Manufactured, CorotationalQuadraticElementsAreOfSecondOrder) {
  print_header();
  for (const ElementShape shape : kQuadratic) {
    const Problem problem{shape, Mesh::mapped, ElasticLaw::corotational};
    EXPECT_GT(order(problem, {2, 4, 6}), 2);
  }
}

/// Rotations of 1e-7 leave no such strain: the solution is that of linear elasticity.
TEST(Manufactured, CorotationalElementsAreLinearInSmallRotations) {
  print_header();
  for (const ElementShape shape : {ElementShape::tet4, ElementShape::hex8, ElementShape::tet10, ElementShape::hex20}) {
    const double small = 1e-7;
    const double turned = order({shape, Mesh::mapped, ElasticLaw::corotational, small}, {2, 4});
    const double linear = order({shape, Mesh::mapped, ElasticLaw::linear, small}, {2, 4});
    EXPECT_NEAR(turned, linear, 1e-4);
  }
}

/// Volumetric strain averaged about nodes keeps the order, nearly incompressible too. The strains are small enough
/// there that no pressure λ tr E exceeds μ: in more compression the St Venant-Kirchhoff material itself is unstable.
TEST(Manufactured, AveragedTetrahedraAreOfSecondOrder) {
  print_header();
  for (const auto& [poisson, amplitude] : {std::pair{0.3, 0.03}, std::pair{0.49, 0.002}})
    for (const ElasticLaw law : {ElasticLaw::st_venant_kirchhoff, ElasticLaw::neo_hookean}) {
      const Problem problem{ElementShape::tet4, Mesh::mapped, law, amplitude, poisson, ElementLocking::averaged};
      EXPECT_GT(order(problem, {4, 8}), 1.9) << poisson;
    }
}

}  // namespace
}  // namespace fascia::manufactured_test
