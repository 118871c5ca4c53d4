// Shells as bodies: rigid motions, free modes, numbering, masses, places, stresses.
#include "core/executor/executor.hpp"
#include "core/linear/block_matrix.hpp"
#include "core/run/modes.hpp"
#include "tests/support/shell_models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace fascia::shell_body_test {
namespace {

using namespace test;

Vec3d barrel(double u, double v) {
  const double a = 1.2 * u, r = 1 + 0.2 * v * (1 - v);
  return {{r * std::cos(a), r * std::sin(a), v}};
}

const ShellMatter kMatter{1e6, 0.3, 0.02, 1000};

double energy_of(const ShellModel& built, const State& state, std::vector<double>& gradient) {
  ThreadPool pool(1);
  CpuExecutor executor(built.model.points, pool);
  gradient.resize(at(built.model.dof_count()));
  return executor.gradient(state, {}, gradient).total();
}

TEST(ShellBody, RigidMotionsCostNothing) {
  const ShellModel built = shell_model(patch_mesh(barrel, {4, 4, Diagonals::right, 0.2}), kMatter);
  const double stiffness = kMatter.young * built.body->volume();
  for (const double angle : {0.5, 3.0}) {
    const Mat3d D = rotation_increment(normalized(Vec3d{{1, 2, -1}}) * angle);
    std::vector<double> g;
    const double energy = energy_of(built, rigid_state(built.model, D, {{5, -3, 2}}), g);
    std::printf("rigid motion by %g rad: energy / (E V) %.1e, force / (E A) %.1e\n", angle, energy / stiffness,
                test::norm(g) / stiffness);
    EXPECT_LT(energy, 1e-28 * stiffness);
    EXPECT_LT(test::norm(g), 1e-12 * stiffness);
  }
}

TEST(ShellBody, ForcesAndTorquesOfAnyStateBalance) {
  const ShellModel built = shell_model(patch_mesh(barrel, {4, 4, Diagonals::left, 0.2}), kMatter);
  const State state = random_state(built.model, 0.05, 0.5);
  std::vector<double> g;
  energy_of(built, state, g);
  Vec3d force, torque;
  double size = 0;
  for (int i = 0; i < built.model.node_count(); ++i) {
    const double* n = g.data() + built.model.points.dofs.begin(i);
    const Vec3d f{{n[0], n[1], n[2]}};
    force += f;
    torque += cross(built.model.rest_position[at(i)] + state.u[at(i)], f) + Vec3d{{n[3], n[4], n[5]}};
    size += norm(f);
  }
  EXPECT_LT(norm(force), 1e-14 * size);
  EXPECT_LT(norm(torque), 1e-14 * size);
}

/// A superposed rotation changes neither the energy nor, in turned axes, the forces.
TEST(ShellBody, EnergyIsObjective) {
  const ShellModel built = shell_model(patch_mesh(barrel, {3, 3}), kMatter);
  const State state = random_state(built.model, 0.05, 0.4);
  const Mat3d D = rotation_increment({{0.7, -1.1, 2}}), R = Mat3d::identity() + D;
  State turned = state;
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    turned.u[i] = R * (built.model.rest_position[i] + state.u[i]) - built.model.rest_position[i];
    turned.D[i] = compose_increments(D, state.D[i]);
  }
  std::vector<double> g, h;
  const double energy = energy_of(built, state, g);
  EXPECT_NEAR(energy_of(built, turned, h), energy, 1e-12 * energy);
  for (int i = 0; i < built.model.node_count(); ++i)
    for (const int k : {0, 3}) {
      const auto n = at(built.model.points.dofs.begin(i) + k);
      const Vec3d a{{g[n], g[n + 1], g[n + 2]}}, b{{h[n], h[n + 1], h[n + 2]}};
      EXPECT_LT(norm(R * a - b), 1e-12 * test::norm(g));
    }
}

/// Six free modes and not one more, flat, curved, thin and nearly incompressible.
TEST(ShellBody, FreeShellHasSixZeroModes) {
  struct Kind {
    const char* name;
    SurfaceMap map;
    double thickness, poisson;
  };
  const SurfaceMap plate = [](double u, double v) { return Vec3d{{u, v, 0}}; };
  const SurfaceMap saddle = [](double u, double v) { return Vec3d{{u, v, u * u - v * v}}; };
  for (const Kind& kind : {Kind{"plate", plate, 0.02, 0.3},
                           {"thin plate", plate, 1e-4, 0.3},
                           {"barrel", barrel, 0.02, 0.3},
                           {"thin barrel", barrel, 1e-4, 0.3},
                           {"saddle", saddle, 0.02, 0.4999}}) {
    ShellMatter matter = kMatter;
    matter.thickness = kind.thickness;
    matter.poisson = kind.poisson;
    const ShellModel built = shell_model(patch_mesh(kind.map, {4, 4, Diagonals::alternating, 0.2}), matter);
    ThreadPool pool(1);
    const Modes modes = natural_modes(built.model, pool, 9);
    std::printf("%-12s", kind.name);
    for (const double f : modes.frequency) std::printf(" %.3g", f);
    std::printf("\n");
    // Rounding of the largest eigenvalue leaves less than a thousandth of the first elastic frequency.
    EXPECT_LT(modes.frequency[5], 1e-3 * modes.frequency[6]) << kind.name;
    EXPECT_GT(modes.frequency[6], 0) << kind.name;
  }
}

/// Nodes and triangles in another order, triangles beginning with another corner.
TEST(ShellBody, NumberingDoesNotMatter) {
  const ShellMesh mesh = patch_mesh(barrel, {4, 3, Diagonals::right, 0.2});
  ShellMesh other = mesh;
  std::vector<int> place(mesh.nodes.size());
  std::iota(place.begin(), place.end(), 0);
  std::mt19937 random(3);
  std::shuffle(place.begin(), place.end(), random);
  for (std::size_t i = 0; i < place.size(); ++i) other.nodes[at(place[i])] = mesh.nodes[i];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t a = 0; a < 3; ++a) other.triangles[t][a] = place[at(mesh.triangles[t][(a + t) % 3])];
  std::shuffle(other.triangles.begin(), other.triangles.end(), random);
  const ShellModel one = shell_model(mesh, kMatter), two = shell_model(other, kMatter);
  const State state = random_state(one.model, 0.05, 0.4);
  State moved_state = state;
  for (std::size_t i = 0; i < place.size(); ++i) {
    moved_state.u[at(place[i])] = state.u[i];
    moved_state.D[at(place[i])] = state.D[i];
  }
  std::vector<double> g, h;
  const double energy = energy_of(one, state, g);
  EXPECT_NEAR(energy_of(two, moved_state, h), energy, 1e-13 * energy);
  for (std::size_t i = 0; i < place.size(); ++i)
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(g[6 * i + k], h[6 * at(place[i]) + k], 1e-12 * test::norm(g));
}

/// Products in chunks of rows: what a chunk has for rows behind it, many of them where a file numbers nodes at random.
TEST(ShellBody, ProductsOfLargeMatricesDoNotDependOnNumbersOrThreads) {
  ShellMesh mesh = patch_mesh(barrel, {70, 70});
  std::vector<int> place(mesh.nodes.size());
  std::iota(place.begin(), place.end(), 0);
  std::mt19937 random(3);
  std::shuffle(place.begin(), place.end(), random);
  ShellMesh other = mesh;
  for (std::size_t i = 0; i < place.size(); ++i) other.nodes[at(place[i])] = mesh.nodes[i];
  for (auto& t : other.triangles)
    for (int& node : t) node = place[at(node)];
  for (const ShellMesh& numbered : {mesh, other}) {
    const ShellModel built = shell_model(numbered, kMatter);
    ThreadPool one(1), two(2);
    CpuExecutor executor(built.model.points, one);
    const auto n = at(built.model.dof_count());
    const std::vector<double> d = random_direction(built.model);
    std::vector<double> free(n), assembled(n), threaded(n);
    executor.gradient(State::at_rest(built.model), {}, free);
    Linearization lin;
    executor.linearize(State::at_rest(built.model), {}, Tangent::full, lin);
    executor.multiply(lin, d, free);
    BlockMatrix matrix(built.model.points);
    EXPECT_TRUE(matrix.fills_upper());
    executor.assemble(lin, matrix);
    matrix.multiply(one, d, assembled);
    matrix.multiply(two, d, threaded);
    EXPECT_EQ(assembled, threaded);
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(assembled[i], free[i], 1e-12 * test::norm(free));
  }
}

TEST(ShellBody, MassAndInertia) {
  const ShellModel built = shell_model(patch_mesh(
                                           [](double u, double v) {
                                             return Vec3d{{2 * u, v, 0}};
                                           },
                                           {40, 20}),
                                       kMatter);
  const Momentum m = total_momentum(built.model, spinning_state(built.model, {{0, 0, 2}}, {{1, 0, 0}}));
  EXPECT_NEAR(m.mass, 2 * 0.02 * 1000, 1e-12);
  EXPECT_NEAR(m.linear[1], 40 * 2 * 1, 1e-9);  // mass × spin × x of the middle
  const double about_origin = 40 * (4.0 + 1.0) / 3;
  EXPECT_NEAR(m.angular[2], about_origin * 2 - 40 * 0.5, 2e-3 * about_origin);  // lumped: order h²
}

TEST(ShellBody, AttachmentsFollowTheDirector) {
  const ShellModel built = shell_model(patch_mesh(barrel, {4, 4}), kMatter);
  const Mat3d D = rotation_increment({{0.3, 0.8, -0.5}});
  const State state = rigid_state(built.model, D, {{1, 2, 3}});
  for (const BodyPoint& p : built.body->points())
    for (const double offset : {0.0, 0.01, -0.01}) {
      const auto& t = built.body->surface().triangles[at(p.cell)];
      const auto& x = built.body->surface().points;
      const Vec3d n = normalized(cross(x[at(t[1])] - x[at(t[0])], x[at(t[2])] - x[at(t[0])]));
      const Vec3d X = p.X + n * offset;
      EXPECT_LT(norm(field_at(built.body->attach(X), state).u - (D * X + Vec3d{{1, 2, 3}})), 1e-13);
      EXPECT_LT(built.body->distance(X), 1e-12);
      EXPECT_NEAR(built.body->distance(p.X + n * 0.05), 0.04, 1e-12);
    }
}

/// Pure bending of a strip: faces at ± E κ t/2, middle without stress.
TEST(ShellBody, StressAtTheFaces) {
  ShellMatter matter = kMatter;
  matter.poisson = 0;
  const ShellModel built = shell_model(patch_mesh([](double u, double v) { return Vec3d{{u, v, 0}}; }, {4, 4}), matter);
  const double curvature = 1e-6;
  State state = State::at_rest(built.model);
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    const double x = built.model.rest_position[i][0];
    state.u[i] = {{0, 0, 0.5 * curvature * x * x}};
    state.D[i] = rotation_increment({{0, -curvature * x, 0}});
  }
  const double stress = matter.young * curvature * matter.thickness / 2;
  const Vec3d X{{0.3, 0.6, 0}}, up{{0, 0, 0.5 * matter.thickness}};
  const auto at_place = [&](const Vec3d& Y) {
    return built.body->tensors_at(built.body->attach(Y), 0, state).stress(0, 0);
  };
  EXPECT_NEAR(at_place(X + up), -stress, 1e-5 * stress);
  EXPECT_NEAR(at_place(X - up), stress, 1e-5 * stress);
  EXPECT_NEAR(at_place(X), 0, 1e-5 * stress);
}

}  // namespace
}  // namespace fascia::shell_body_test
