#include "tests/random/random_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fascia::random_scenes {
namespace {

bool is_shell(const Json& body) { return body["model"] == "shell"; }

/// A surface that encloses a space.
bool is_closed(const Json& body) {
  const Json& domain = body["domain"];
  if (is_shell(body)) return domain.contains("cylinder") || domain.contains("ellipsoid");
  const bool has_faces = body["model"] == "tetrahedra" || body["model"] == "hexahedra" || body["model"] == "meshless";
  return has_faces && (domain.contains("box") || domain.contains("block") || domain.contains("file")) &&
         !body.contains("thickness");
}

/// Returns the volume of the space in a box, or in the prism that a cylinder's shell is [m³]; 0 where it is not known.
double volume_of(const Json& domain) {
  if (domain.contains("box")) {
    double volume = 1;
    for (std::size_t a = 0; a < 3; ++a)
      volume *= domain["box"]["max"][a].get<double>() - domain["box"]["min"][a].get<double>();
    return volume;
  }
  if (!domain.contains("cylinder")) return 0;
  const Json& tube = domain["cylinder"];
  const int sides = tube["cells"][1];
  const double radius = tube["radius"], length = tube["to"][0].get<double>() - tube["from"][0].get<double>();
  return 0.5 * sides * radius * radius * std::sin(2 * std::numbers::pi / sides) * length;
}

/// A pressure that strains a solid by a part of one, or bends a flat cap by about its thickness at most [Pa].
double pressure_for(Draws& draws, const Scales& s, const RowBody& b, const Json& body) {
  if (!is_shell(body)) return b.young * draws.decades(-7, -1);
  const double slender = body["thickness"].get<double>() / (0.5 * s.width);
  return b.young * std::pow(slender, 4) * draws.decades(-4, 0.5);
}

}  // namespace

void add_closed_shell(Draws& draws, const Scales& s, std::vector<RowBody>& row, Json& scene) {
  RowBody& b = row.back();
  Json& body = scene["bodies"][b.name];
  if (!body.contains("material")) return;
  Json shell = Json::object({{"model", "shell"}});
  const double middle = 0.5 * s.width;
  if (row.size() == 1 && draws.chance(0.4)) {  // an end that is a point holds no other body
    shell["domain"]["ellipsoid"] = Json{{"center", {0.5 * (b.from + b.to), middle, middle}},
                                        {"radii", {0.5 * (b.to - b.from), middle, 0.8 * middle}},
                                        {"cells", Json::array({4 * draws.whole(1, 3)})}};
  } else {
    Json& tube = shell["domain"]["cylinder"];
    tube = Json{{"from", {b.from, middle, middle}},
                {"to", {b.to, middle, middle}},
                {"radius", middle},
                {"cells", {draws.whole(1, 3), 4 * draws.whole(1, 3)}}};
    if (draws.chance(0.5)) tube["caps"] = true;
    tube["diagonal"] = draws.word("bodies.*.domain.cylinder.diagonal");
  }
  shell["thickness"] = s.width * draws.decades(-2.5, -0.7);
  for (const char* key : {"density", "mass", "material", "initial"})
    if (body.contains(key)) shell[key] = body[key];
  take_moduli(shell["material"]);
  body = std::move(shell);
  b.thin = b.has_boundary = true;
  b.solid = false;
}

void add_fluid(Draws& draws, bool flies, const std::vector<RowBody>& row, RandomScene& scene) {
  const Scales& s = scene.scales;
  std::vector<const RowBody*> closed;
  for (const RowBody& b : row)
    if (is_closed(scene.tree["bodies"][b.name])) closed.push_back(&b);
  if (closed.empty()) return;
  const RowBody& b = *draws.pick(closed);
  const bool weighs = !flies && draws.chance(0.4);
  if (weighs && !scene.tree.contains("world")) add_gravity(draws, s, scene.tree);
  Json& body = scene.tree["bodies"][b.name];
  const double pressure = pressure_for(draws, s, b, body) * (draws.chance(0.8) ? 1 : -1);
  const bool along_a_path = scene.tree["solver"].value("control", "load") != "load";
  Json fluid = Json::object();
  if (along_a_path || draws.chance(0.4)) {
    fluid["pressure"] = pressure;
    scene.features.emplace_back("fluid with a pressure");
  } else {
    const double modulus = std::abs(pressure) * draws.decades(1, 5), volume = volume_of(body["domain"]);
    fluid["bulk_modulus"] = modulus;
    if (volume > 0 && draws.chance(0.7)) fluid["volume"] = volume * (1 + pressure / modulus);
    scene.scales.stiffest = std::max(s.stiffest, modulus);
    scene.features.emplace_back("fluid with a bulk modulus");
  }
  if (weighs) {
    const Vector g = scene.tree["world"]["gravity"].get<Vector>();
    fluid["density"] = std::abs(pressure) * draws.decades(-3, 0) / (std::hypot(g[0], g[1], g[2]) * s.width);
    scene.features.emplace_back("fluid with a weight");
  }
  add_schedule(draws, scene.tree, fluid);
  scene.load_size += 6 * std::abs(pressure) * s.width * s.length;
  body["fluid"] = std::move(fluid);
  scene.features.push_back("fluid in " + body["model"].get<std::string>());
}

}  // namespace fascia::random_scenes
