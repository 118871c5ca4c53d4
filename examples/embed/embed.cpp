// A block of tissue on a support that the program moves: cmake -B build && cmake --build build && build/embed
#include <fascia/stepper.hpp>

#include <cmath>
#include <cstdio>
#include <exception>

int main(int argc, char** argv) try {
  fascia::Body block;
  block.name = "block";
  block.domain = fascia::BoxDomain{{{0, 0, 0}}, {{0.04, 0.04, 0.1}}};  // [m]
  block.frames = fascia::GridFrames{{3, 3, 6}};
  block.density = 1000;                                         // [kg/m3]
  block.materials.push_back({{}, fascia::elastic(20e3, 0.4)});  // [Pa]

  fascia::Constraint support;
  support.body = block.name;
  support.where = fascia::in_box({{-1, -1, -0.001}}, {{1, 1, 0.001}});
  support.fixed.fill(true);
  support.driver = "table";

  fascia::Scene scene;
  scene.world.gravity = {{0, 0, -9.81}};
  scene.bodies = {block};
  scene.constraints = {support};
  scene.solver.kind = fascia::SolverKind::implicit_euler;
  if (argc > 1) scene.solver.backend = argv[1];  // "cuda"

  fascia::Stepper stepper(scene);
  const int table = stepper.driver("table");
  const fascia::Rows positions = stepper.positions();  // stays where it is
  for (int i = 1; i <= 100; ++i) {
    stepper.set_motion(table, {.translation = {{0.02 * std::sin(0.1 * i), 0, 0}}});
    if (const auto step = stepper.step(0.01); !step.converged) return std::puts(step.message.c_str()), 1;
  }
  const auto top = positions[positions.rows - 1];
  std::printf("t = %g s: the top is at (%.5f, %.5f, %.5f) m\n", stepper.time(), top[0], top[1], top[2]);
} catch (const std::exception& e) {
  return std::fprintf(stderr, "%s\n", e.what()), 1;
}
