#include "tests/random/random_scene.hpp"

#include "assembly/actions/actions.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::random_scenes {
namespace {

/// Sets apart the draws of what one scene in five has beside the rest. None of the seeds that tests name is of these.
constexpr std::uint64_t kMore = 0xb4;

/// Sets apart the draws of stresses that fade; none of the named seeds is of these either.
constexpr std::uint64_t kFading = 0x10d;

/// Sets apart the draws of muscles; likewise.
constexpr std::uint64_t kMuscle = 0x1aa;

struct Additions {
  explicit Additions(Draws& draws) {
    if (!draws.chance(0.2)) return;
    fluid = draws.chance(0.5);
    tissue = draws.chance(0.6);
    mesh = draws.chance(0.5) || !(fluid || tissue);
  }
  bool fluid = false, tissue = false, mesh = false;
};

/// Draws one or several branches, which fade within the run, long before or long after.
Json viscosity(Draws& draws, const Scales& scales) {
  Json branches = Json::array();
  const int count = draws.whole(1, 3);
  for (int k = 0; k < count; ++k)
    branches.push_back(
        Json{{"share", draws.uniform(0.01, 0.9 / count)}, {"time", scales.time() * draws.decades(-3, 3)}});
  return branches;
}

/// One scene in seven has materials whose stress fades, of each body in its own way.
void add_viscosity(Draws& draws, const Scales& scales, Json& scene) {
  if (!draws.chance(0.15)) return;
  for (auto& [name, body] : scene["bodies"].items()) {
    if (!body.contains("material") || draws.chance(0.4)) continue;
    const Json branches = viscosity(draws, scales);
    const bool thin = body.value("model", "") == "shell" || body.contains("thickness") || body.contains("radius") ||
                      body["domain"].contains("as") || body.contains("locking");
    const bool shear = !thin && draws.chance(0.3);
    const bool at_once = draws.chance(0.3) && scene["solver"]["kind"] == "static";
    const auto add = [&](Json& material) {
      material["viscosity"] = branches;
      if (shear) material["relax"] = "shear";
      if (at_once) material["statics"] = "instantaneous";
      if (material.contains("damping")) material["damping"].erase("stiffness");
    };
    if (body["material"].is_array())
      for (Json& part : body["material"]) add(part["use"]);
    else
      add(body["material"]);
  }
}

/// One scene in ten has a body of muscle, whose fibres pull with a part of its stiffness.
void add_muscle(Draws& draws, Json& scene) {
  if (!draws.chance(0.1) || scene["solver"].value("kind", "") == "central-differences") return;
  for (auto& [name, body] : scene["bodies"].items()) {
    Json& material = body.contains("material") ? body["material"] : body;
    if (body.value("model", "") == "shell" || !material.is_object() || !material.contains("young")) continue;
    material["fibres"] = Json::array({Json{{"direction", draws.directed(1)}}});
    material["active"] = Json{{"stress", material["young"].get<double>() * draws.decades(-6, -1)}};
    return;
  }
}

}  // namespace

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
  Draws more(seed ^ kMore);
  const Additions with(more);
  if (with.fluid && more.chance(0.5)) add_closed_shell(more, scales, row, scene.tree);
  for (const RowBody& b : row) scales.stiffest = std::max(scales.stiffest, b.young);
  add_couplings(draws, scales, row, scene.tree);
  const bool flies = scene.tree["solver"].contains("time_step") && draws.chance(0.3);  // what moves keeps its momentum
  if (flies) {
    if (scene.tree.contains("couplings")) scene.tree["couplings"].erase("tie");
  } else {
    add_constraints(draws, scales, row, scene.tree);
    add_loads(draws, scales, row, scene);
  }
  if (with.tissue) add_tissue(more, scales, flies, row, scene);
  if (with.mesh) add_mesh(more, scales, row, fmt::format("{}", seed), scene);
  if (with.fluid) add_fluid(more, flies, row, scene);
  Draws fading(seed ^ kFading);
  add_viscosity(fading, scales, scene.tree);
  Draws pulling(seed ^ kMuscle);
  add_muscle(pulling, scene.tree);
  add_probes(scales, row, scene.tree);
  if (draws.chance(0.125) && scene.wrong.empty()) spoil(draws, scene);
  return scene;
}

double sliver(const Scales& s) { return 1e-3 * s.width; }

Json slab(double from, double to, const Scales& scales) {
  const double far = 1e3 * scales.length;
  return Json::object({{"box", Json{{"min", {from, -far, -far}}, {"max", {to, far, far}}}}});
}

Json end_of(const RowBody& b, bool far, const Scales& s) {
  const double x = far ? b.to : b.from;
  return slab(x - sliver(s), x + sliver(s), s);
}

bool is_rectangle(const Json& body) { return body["domain"].contains("rectangle"); }

}  // namespace fascia::random_scenes
