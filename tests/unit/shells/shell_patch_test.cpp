// Patch tests: states that every mesh must reproduce.
#include "core/executor/executor.hpp"
#include "tests/support/shell_models.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fascia::shell_patch_test {
namespace {

using namespace test;

const ShellMatter kMatter{1e4, 0.3, 0.05, 1000};

Vec3d flat(double u, double v) { return {{1.2 * u + 0.3 * v, 0.8 * v + 0.1 * u, 0}}; }

/// An irregular flat mesh in some place and attitude.
ShellModel turned_patch(const Mat3d& R, const ShellMatter& matter = kMatter) {
  return shell_model(patch_mesh(
                         [R](double u, double v) {
                           return R * flat(u, v) + Vec3d{{3, -2, 1}};
                         },
                         {5, 4, Diagonals::alternating, 0.3}),
                     matter);
}

/// Holds the rim at a field's displacements and rotations (in steps of the load factor) and solves for the inside.
/// Returns the largest deviation from the field over its largest displacement.
template <class Displacement, class Rotation>
double interior_error(ShellModel& built, const Displacement& u, const Rotation& r) {
  const std::vector<char> rim = built.body->nodes_on_boundary();
  State state = State::at_rest(built.model);
  for (int i = 0; i < built.model.node_count(); ++i) {
    if (rim[at(i)] == 0) continue;
    FrameConstraint c;
    c.node = i;
    c.translations = c.rotations = 3;
    const Vec3d turn = r(built.model.rest_position[at(i)]);
    PrescribedMotion place, rotation;
    place.translation = u(built.model.rest_position[at(i)]);
    rotation.axis = norm(turn) > 0 ? normalized(turn) : Vec3d{{0, 0, 1}};
    rotation.angle = norm(turn);
    const int first = static_cast<int>(built.model.motions.size());
    c.translation_motion.fill(first);
    c.rotation_motion.fill(first + 1);
    built.model.motions.push_back(place);
    built.model.motions.push_back(rotation);
    built.model.constraints.push_back(c);
  }
  ThreadPool pool(1);
  SolverSettings settings;
  settings.tolerance = 1e-13;
  MechanicalSystem system(built.model, pool, settings);
  state = State::at_rest(built.model);
  const RunReport report = run_statics(system, state, kRamp, settings, {1}, {});
  EXPECT_EQ(report.status, RunStatus::converged) << report.message;
  double largest = 0, error = 0;
  for (int i = 0; i < built.model.node_count(); ++i) {
    const Vec3d& X = built.model.rest_position[at(i)];
    largest = std::max(largest, norm(u(X)));
    error = std::max({error, norm(state.u[at(i)] - u(X)), norm(rotation_vector(state.D[at(i)]) - r(X))});
  }
  return error / largest;
}

/// Large homogeneous stretch and shear in the plane: exact whatever the size, since the strain is Green's.
TEST(ShellPatch, Membrane) {
  const Mat3d R = rotation_about(normalized(Vec3d{{1, 2, 3}}), 0.9);
  ShellModel built = turned_patch(R);
  Mat3d A;
  A(0, 0) = 0.2;
  A(0, 1) = A(1, 0) = 0.07;
  A(1, 1) = -0.1;
  const auto u = [&](const Vec3d& X) { return R * (A * (transpose(R) * X)); };
  const double error = interior_error(built, u, [](const Vec3d&) { return Vec3d{}; });
  std::printf("membrane patch: deviation %.1e\n", error);
  EXPECT_LT(error, 1e-9);
}

/// w = ½ (a x² + b y²) + c x y, so small that it is linear: constant moments, thick and thin.
TEST(ShellPatch, Bending) {
  for (const double thickness : {0.2, 0.05, 1e-3}) {
    const Mat3d R = rotation_about(normalized(Vec3d{{1, -1, 2}}), 0.5);
    ShellMatter matter = kMatter;
    matter.thickness = thickness;
    ShellModel built = turned_patch(R, matter);
    const double scale = 1e-9, a = 1, b = -0.4, c = 0.7;
    const auto local = [&](const Vec3d& X) { return transpose(R) * (X - Vec3d{{3, -2, 1}}); };
    const auto u = [&](const Vec3d& X) {
      const Vec3d x = local(X);
      return R * Vec3d{{0, 0, scale * (0.5 * a * x[0] * x[0] + 0.5 * b * x[1] * x[1] + c * x[0] * x[1])}};
    };
    const auto r = [&](const Vec3d& X) {
      const Vec3d x = local(X);
      return R * Vec3d{{scale * (b * x[1] + c * x[0]), -scale * (a * x[0] + c * x[1]), 0}};
    };
    const double error = interior_error(built, u, r);
    std::printf("bending patch, thickness %g: deviation %.1e\n", thickness, error);
    EXPECT_LT(error, 1e-9);  // the square of the slopes stretches the plane

    const State state = [&] {
      State s = State::at_rest(built.model);
      for (int i = 0; i < built.model.node_count(); ++i) {
        s.u[at(i)] = u(built.model.rest_position[at(i)]);
        s.D[at(i)] = rotation_increment(r(built.model.rest_position[at(i)]));
      }
      return s;
    }();
    // Moments of every triangle: D (κ₁₁ + ν κ₂₂), ...
    const double D = matter.young * std::pow(thickness, 3) / 12 / (1 - matter.poisson * matter.poisson);
    for (const BodyField& f : built.body->own_fields(state)) {
      if (f.name != "bending_moment") continue;
      for (std::size_t k = 0; k < f.values.size(); k += 9) {
        Mat3d M;
        for (int i = 0; i < 9; ++i) M(i / 3, i % 3) = f.values[k + at(i)];
        M = transpose_times(R, M * R);
        EXPECT_NEAR(M(0, 0), -D * scale * (a + matter.poisson * b), 1e-6 * D * scale);
        EXPECT_NEAR(M(1, 1), -D * scale * (b + matter.poisson * a), 1e-6 * D * scale);
        EXPECT_NEAR(M(0, 1), -D * scale * (1 - matter.poisson) * c, 1e-6 * D * scale);
      }
    }
  }
}

/// A rectangle of two triangles bent in its plane has the energy of a beam, whatever its aspect ratio and ν.
TEST(ShellPatch, BendingInThePlaneIsExact) {
  for (const double poisson : {0.0, 0.3})
    for (const double aspect : {1.0, 4.0, 16.0}) {
      const auto map = [&](double u, double v) { return Vec3d{{aspect * (u - 0.5), v - 0.5, 0}}; };
      const ShellMatter matter{1, poisson, 1, 1};
      const ShellModel built = shell_model(patch_mesh(map, {1, 1}), matter);
      const double k = 1e-6;
      State state = State::at_rest(built.model);
      for (std::size_t i = 0; i < state.u.size(); ++i) {
        const Vec3d& X = built.model.rest_position[i];
        state.u[i] = {{k * X[0] * X[1], -0.5 * k * (X[0] * X[0] + poisson * X[1] * X[1]), 0}};
        state.D[i] = rotation_increment({{0, 0, -k * X[0]}});
      }
      ThreadPool pool(1);
      CpuExecutor executor(built.model.points, pool);
      std::vector<double> g(at(built.model.dof_count()));
      const double energy = executor.gradient(state, {}, g).elastic;
      EXPECT_NEAR(energy / (0.5 * k * k * aspect / 12), 1.0, 1e-5) << "aspect " << aspect << ", ν " << poisson;
    }
}

}  // namespace
}  // namespace fascia::shell_patch_test
