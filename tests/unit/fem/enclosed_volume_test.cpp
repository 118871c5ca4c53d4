// Newton's method with a stiff enclosed volume: its convergence, and the two linear solvers.
#include "core/body/body_surface.hpp"
#include "tests/unit/fem/element_models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace fascia::enclosed_volume_test {
namespace {

using namespace test;

/// A slab held at one face, filled to more than its volume.
ElementModel filled(double bulk_modulus) {
  ElementOptions o;
  o.shape = ElementShape::tet10;
  o.law = Law::neo_hookean;
  ElementModel built = element_model(o);
  SurfaceLoad load = surface_of(*built.body, built.body->faces());
  load.bulk_modulus = bulk_modulus;
  load.volume = 1.3 * load.rest_volume;
  load.weight = {{0, 0, -500}};
  built.model.surfaces.push_back(load);
  const BodyFace held = built.body->faces()[0];
  for (const int node : held) {
    FrameConstraint c;
    c.node = node;
    c.translations = 3;
    const bool known = std::any_of(built.model.constraints.begin(), built.model.constraints.end(),
                                   [&](const FrameConstraint& k) { return k.node == node; });
    if (!known) built.model.constraints.push_back(c);
  }
  std::sort(built.model.constraints.begin(), built.model.constraints.end(),
            [](const FrameConstraint& a, const FrameConstraint& b) { return a.node < b.node; });
  return built;
}

TEST(StiffVolume, NewtonConvergesQuadratically) {
  for (const double bulk_modulus : {1e5, 1e9}) {
    const ElementModel built = filled(bulk_modulus);
    ThreadPool pool(1);
    MechanicalSystem system(built.model, pool, {});
    system.set_factors(std::vector<double>{1});
    system.begin_step(State::at_rest(built.model), 0);
    std::vector<double> relative;
    Evaluation e = system.evaluate();
    const double scale = bulk_modulus;
    for (int k = 0; k < 12 && !e.converged(); ++k) {
      relative.push_back(e.residual / scale);
      system.direction();
      system.apply(1);
      e = system.evaluate();
    }
    relative.push_back(e.residual / scale);
    std::printf("K = %.0e Pa:", bulk_modulus);
    for (const double r : relative) std::printf(" %.1e", r);
    std::printf("\n");
    EXPECT_TRUE(e.converged());
    EXPECT_LE(relative.size(), 9u);
    for (std::size_t k = relative.size() - 2; k < relative.size(); ++k)
      EXPECT_LT(relative[k] / relative[0], std::pow(relative[k - 1] / relative[0], 1.5))
          << "the last steps are those of a quadratic convergence";
    const SurfacesView& surfaces = system.surfaces().view();
    const double pressure = surfaces.figure(0, kPressure), volume = surfaces.figure(0, kVolumeInside);
    EXPECT_GT(pressure, 0);
    EXPECT_LT(std::abs(volume / built.model.surfaces[0].volume - 1), 1.01 * pressure / bulk_modulus);
  }
}

TEST(StiffVolume, ConjugateGradientsAndCholeskyAgree) {
  const ElementModel built = filled(1e9);
  ThreadPool pool(2);
  std::vector<State> states;
  for (const LinearMethod method : {LinearMethod::cholesky, LinearMethod::cg}) {
    SolverSettings settings;
    settings.linear = method;
    MechanicalSystem system(built.model, pool, settings);
    State state = State::at_rest(built.model);
    const RunReport run = run_statics(system, state, kRamp, settings, {}, nullptr);
    EXPECT_EQ(run.status, RunStatus::converged) << run.message;
    std::printf("%d Newton iterations, %d linear\n", run.newton_iterations, run.linear_iterations);
    states.push_back(state);
  }
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < states[0].u.size(); ++i) {
    difference += squared_norm(states[0].u[i] - states[1].u[i]);
    size += squared_norm(states[0].u[i]);
  }
  EXPECT_LT(std::sqrt(difference / size), 1e-6);  // the tolerance of Newton's method is 1e-8 of the forces
}

}  // namespace
}  // namespace fascia::enclosed_volume_test
