#include "app/bench/benchmark.hpp"
#include "app/bench/scenes.hpp"

#include <fmt/format.h>

namespace fascia::app {
namespace {

constexpr const char* kSolver = R"(
[solver]
kind = "implicit-euler"
time_step = "10 ms"
steps = 100
newton = { max_iterations = 1, on_limit = "continue" }
linear = { kind = "cg", max_iterations = 60, tolerance = 1e-15 }   # always 60
)";

/// A clamped block. @param model, cells  as the scene has them
std::string block_scene(const std::string& title, const char* model, const std::string& cells) {
  return fmt::format(R"(title = "{}"

[world]
gravity = [0, 0, -9.81]

[bodies.block]
model = "{}"
domain = {{ box = {{ min = [0, 0, 0], max = ["10 cm", "10 cm", "20 cm"], {} }} }}
density = 1000
material = {{ young = "50 kPa", poisson = 0.4 }}

[[constraints]]
body = "block"
where = {{ box = {{ min = [-1, -1, -1], max = [1, 1, 1e-6] }} }}
fix = "all"
{})",
                     title, model, cells, kSolver);
}

}  // namespace

std::string tetrahedra_scene(int x, int y, int z) {
  return block_scene(fmt::format("{} tetrahedra", 5 * x * y * z), "tetrahedra",
                     fmt::format("cells = [{}, {}, {}], split = 5", x, y, z));
}

std::string hexahedra_scene(int x, int y, int z) {
  return block_scene(fmt::format("{} hexahedra", x * y * z), "hexahedra", fmt::format("cells = [{}, {}, {}]", x, y, z));
}

std::string shell_scene(int u, int v) {
  return fmt::format(R"(title = "{} shell triangles"

[world]
gravity = [0, 0, -9.81]

[bodies.plate]
model = "shell"
domain = {{ rectangle = {{ origin = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1.6, 0], cells = [{}, {}] }} }}
thickness = "1 cm"
density = 1000
material = {{ young = "1 MPa", poisson = 0.3 }}

[[constraints]]
body = "plate"
where = {{ any_of = [{{ group = "u0" }}, {{ group = "u1" }}] }}
fix = "all"
{})",
                     2 * u * v, u, v, kSolver);
}

std::string coupled_scene(int cells, int frames, int points) {
  const std::string wall = R"(model = "shell"
thickness = "2 cm"
density = 1000
material = { young = "500 kPa", poisson = 0.3, damping = { mass = 2, stiffness = 0.01 } }
)";
  const auto rectangle = [&](double z) {
    return fmt::format(
        "domain = {{ rectangle = {{ origin = [-0.5, -0.5, {}], edge_u = [1, 0, 0], edge_v = [0, 1, 0], cells = [{}, "
        "{}] "
        "}} }}\n",
        z, cells, cells);
  };
  return fmt::format(R"(title = "Two walls of {0} x {0} cells and tissue between them"

[world]
gravity = [0, 0, -9.81]

[bodies.upper]
{1}{2}
[bodies.lower]
{1}{3}
[bodies.tissue]
model = "meshless"
domain = {{ box = {{ min = [-0.215, -0.215, 0], max = [0.215, 0.215, 0.3] }} }}
frames = {{ count = {4}, share = [{{ body = "upper", where = {{ box = {{ min = [-0.22, -0.22, 0.29], max = [0.22, 0.22, 0.31] }} }} }}, {{ body = "lower", where = {{ box = {{ min = [-0.22, -0.22, -0.01], max = [0.22, 0.22, 0.01] }} }} }}] }}
points = {{ count = {5} }}
weights = {{ kind = "shepard", neighbours = 4 }}
mass = "1 kg"
material = {{ young = "6 kPa", poisson = 0.3, damping = {{ mass = 2, stiffness = 0.01 }} }}

[[constraints]]
body = "upper"
where = {{ any_of = [{{ group = "u0" }}, {{ group = "u1" }}] }}
fix = "all"
{6})",
                     cells, wall, rectangle(0.3), rectangle(0), frames, points, kSolver);
}

Benchmark elements() {
  Benchmark b{"gpu",
              "Finite elements, shells and a coupled scene: time steps of 60 CG iterations",
              "Sizes count tetrahedra, triangles, and integration points of the coupled scene's tissue.",
              200000,
              {}};
  const auto add = [&](const char* name, const char* body, int size, std::string scene) {
    b.cases.push_back({name, body, "default", size, std::move(scene), {}, {}});
  };
  add("gpu_tetrahedra_1e5", "tetrahedra", 100000, tetrahedra_scene(20, 20, 50));
  add("gpu_shells_5e4", "shells", 50000, shell_scene(125, 200));
  add("gpu_coupling", "coupling", 8000, coupled_scene(55, 800, 8000));
  add("gpu_tetrahedra_1e6", "tetrahedra", 1000000, tetrahedra_scene(50, 50, 80));
  return b;
}

}  // namespace fascia::app
