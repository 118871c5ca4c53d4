#include "app/bench/scenes.hpp"

#include <fmt/format.h>

namespace fascia::app {
namespace {

/// A free beam of soft tissue, pulled at both ends by a hundredth of its stiffness, so that it never comes near to an
/// instability; one Newton iteration of 60 CG iterations a step. Placeholders: title, frames, points, weights,
/// preconditioner.
constexpr const char* kBeam = R"(title = "{}"

[bodies.beam]
model = "meshless"
domain = {{ box = {{ min = [0, 0, 0], max = ["40 cm", "10 cm", "10 cm"] }} }}
density = 1000
material = {{ young = "40 kPa", poisson = 0.3 }}
frames = {{ {} }}
{}weights = {{ {} }}

[[loads]]
body = "beam"
where = {{ box = {{ min = [-1, -1, -1], max = [0.001, 1, 1] }} }}
traction = ["-400 Pa", 0, 0]

[[loads]]
body = "beam"
where = {{ box = {{ min = [0.399, -1, -1], max = [1, 1, 1] }} }}
traction = ["400 Pa", 0, 0]

[solver]
kind = "implicit-euler"
time_step = "10 ms"
steps = 100
newton = {{ max_iterations = 1, on_limit = "continue" }}
linear = {{ kind = "cg", preconditioner = "{}", max_iterations = 60, tolerance = 1e-15 }}   # always 60
)";

std::string preconditioner(const std::string& setting) { return setting == "paper" ? "none" : "auto"; }

}  // namespace

std::string scattered_beam(const std::string& title, const std::string& frames, const std::string& points,
                           int neighbours, const std::string& setting) {
  const std::string weights = fmt::format("kind = \"shepard\", neighbours = {}{}", neighbours,
                                          setting == "paper" ? ", blend = \"full\", drilling = 0" : "");
  return fmt::format(kBeam, title, frames, fmt::format("points = {{ {} }}\n", points), weights,
                     preconditioner(setting));
}

std::string grid_beam(const std::array<int, 3>& cells, const std::string& setting) {
  const int points = 24 * cells[0] * cells[1] * cells[2];
  return fmt::format(kBeam, fmt::format("{} points, 4 neighbours, grid", points),
                     fmt::format("grid = [{}, {}, {}]", cells[0] + 1, cells[1] + 1, cells[2] + 1), "",
                     setting == "paper" ? "kind = \"linear\", blend = \"full\", drilling = 0" : "kind = \"linear\"",
                     preconditioner(setting));
}

}  // namespace fascia::app
