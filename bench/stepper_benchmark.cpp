#include "fascia/stepper.hpp"

#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "core/base/clock.hpp"
#include "core/run/drivers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

// stepper_benchmark: what a call of Stepper::step() takes beyond the same step in a run, on the smallest scene that
// there is, a rigid body that falls. Pairs of 20,000 steps each; the median of the differences is the call.

namespace {

using namespace fascia;

constexpr int kSteps = 20000, kPairs = 15;

Scene falling_body() {
  Body body;
  body.name = "stone";
  body.model = BodyModel::rigid;
  body.domain = BoxDomain{{{0, 0, 0}}, {{0.1, 0.1, 0.1}}};
  body.mass = 1;
  Scene scene;
  scene.world.gravity = {{0, 0, -9.81}};
  scene.bodies = {body};
  scene.solver.kind = SolverKind::implicit_euler;
  scene.solver.time_step = 1e-4;
  scene.solver.steps = kSteps;
  scene.solver.threads = 1;
  return scene;
}

double seconds_of_run() {
  const Simulation s = build_simulation(falling_body());
  ThreadPool pool(1);
  const SolverSettings settings = settings_of(s.scene.solver);
  MechanicalSystem system(s.model, pool, settings);
  State state = s.initial;
  const Clock::time_point start = Clock::now();
  run_implicit(system, state, [&](double t) { return s.factors(t); }, settings, dynamics_of(s.scene.solver), {});
  return seconds_since(start);
}

double seconds_of_steps(bool views) {
  Stepper stepper(falling_body());
  if (views) stepper.positions();
  const Clock::time_point start = Clock::now();
  for (int step = 0; step < kSteps; ++step) stepper.step(1e-4);
  return seconds_since(start);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + kPairs / 2, values.end());
  return values[kPairs / 2];
}

}  // namespace

int main() {
  std::vector<double> run, call, seen;
  for (int pair = 0; pair < kPairs; ++pair) {
    const double of_run = seconds_of_run();
    run.push_back(of_run);
    call.push_back(seconds_of_steps(false) - of_run);
    seen.push_back(seconds_of_steps(true) - of_run);
  }
  constexpr double micro = 1e6 / kSteps;
  fmt::print("a step in a run {:.2f} us; a call beyond it {:.2f} us, with positions {:.2f} us\n", micro * median(run),
             micro * median(call), micro * median(seen));
}
