#include "tests/random/random_scene.hpp"

#include <algorithm>

namespace fascia::random_scenes {

RandomScene random_scene(std::uint64_t seed) {
  Draws draws(seed);
  RandomScene scene;
  Scales& scales = scene.scales;
  scales.length = draws.decades(-4, 4);
  scales.width = scales.length * draws.uniform(0.1, 0.6);
  scales.young = draws.decades(0, 12);
  scales.density = draws.decades(0, 4.5);
  add_solver(draws, scales, scene.tree);
  std::vector<RowBody> row = add_bodies(draws, scales, scene.tree);
  for (const RowBody& b : row) scales.stiffest = std::max(scales.stiffest, b.young);
  add_couplings(draws, scales, row, scene.tree);
  const bool flies = scene.tree["solver"].contains("time_step") && draws.chance(0.3);  // what moves keeps its momentum
  if (flies) {
    if (scene.tree.contains("couplings")) scene.tree["couplings"].erase("tie");
  } else {
    add_constraints(draws, scales, row, scene.tree);
    add_loads(draws, scales, row, scene);
  }
  add_probes(scales, row, scene.tree);
  if (draws.chance(0.125)) spoil(draws, scene);
  return scene;
}

Json slab(double from, double to, const Scales& scales) {
  const double far = 1e3 * scales.length;
  return Json::object({{"box", Json{{"min", {from, -far, -far}}, {"max", {to, far, far}}}}});
}

}  // namespace fascia::random_scenes
