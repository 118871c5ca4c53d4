#include "tests/random/random_scene.hpp"

namespace fascia::random_scenes {

namespace {

/// How the equations of a step are solved: so tightly that twins can be compared.
void add_equations(Draws& draws, Json& solver) {
  solver["newton"] = Json{{"tolerance", 1e-10}, {"max_iterations", 25}};
  const bool path = solver.value("control", "load") != "load";
  solver["linear"]["kind"] = path ? "cholesky" : draws.word("solver.linear.kind");
  if (solver["linear"]["kind"] == "cg") {
    solver["linear"]["max_iterations"] = 20000;
    if (draws.chance(0.3)) solver["linear"]["preconditioner"] = draws.word("solver.linear.preconditioner");
    if (solver["linear"].value("preconditioner", "") == "none")
      solver["linear"]["max_iterations"] = 1000;  // minutes else
  }
  if (!path && draws.chance(0.1)) solver["tangent"] = draws.word("solver.tangent");
}

}  // namespace

void add_solver(Draws& draws, const Scales& s, Json& scene) {
  const std::string kind = draws.chance(0.5) ? "static" : draws.word("solver.kind");
  Json solver{{"kind", kind}, {"backend", "cpu"}};
  if (kind == "modes") solver["count"] = draws.whole(1, 8);
  if (kind == "static") {
    if (draws.chance(0.3)) solver["load_steps"] = draws.whole(1, 4);
    if (draws.chance(0.1)) solver["control"] = draws.word("solver.control");
    if (solver.value("control", "load") != "load") solver["max_steps"] = 60;
    if (draws.chance(0.05)) solver["imperfection"] = draws.decades(-6, -2);
  } else if (kind != "modes") {
    solver["time_step"] = s.time() * (kind == "explicit" ? draws.decades(-5, -3) : draws.decades(-3, 2));
    solver["steps"] = kind == "explicit" ? draws.whole(5, 40) : draws.whole(2, 5);
    scene["output"]["every_steps"] = 1;
  }
  if (draws.chance(0.9)) scene["output"]["fields"] = Json::array({"displacement"});
  if (kind != "explicit" && kind != "modes") add_equations(draws, solver);
  scene["solver"] = solver;
}

void add_probes(const Scales& s, const std::vector<RowBody>& row, Json& scene) {
  Json& probes = scene["probes"];
  if (scene["solver"]["kind"] == "modes") {
    probes["frequencies"] = Json::object({{"quantity", "frequency"}});
    return;
  }
  for (const RowBody& b : row) {
    const auto add = [&](const std::string& quantity, const Json& more = Json::object()) {
      Json& probe = probes[b.name + "_" + quantity];
      probe = Json{{"quantity", quantity}, {"body", b.name}};
      probe.update(more);
    };
    const Json& body = scene["bodies"][b.name];
    const Json& domain = body["domain"];
    // No place of the row's section need be a point of these.
    const bool elsewhere = domain.contains("cylinder") || domain.contains("ellipsoid") || domain.contains("as");
    // Within a cell, where strains are not of two.
    const bool line = domain.contains("line");
    const double y = line ? 0.5 : 0.44, z = b.thin ? 0.5 : b.carried ? 0.2 : b.stiff ? 0 : 0.29;
    const Json at = Json::object({{"at", {b.from + 0.71 * (b.to - b.from), y * s.width, b.lift + z * s.width}}});
    const bool statics = scene["solver"]["kind"] == "static";
    if (!elsewhere) add("displacement", at), add("rotation", at);
    if (!elsewhere && !statics) add("velocity", at);
    if (!b.stiff && !b.carried) {
      if (!elsewhere) add("strain", at), add("stress", at);
      add("energy");
    }
    add("max_displacement");
    if (body.contains("fluid")) add("fluid_volume"), add("fluid_pressure");
    Json held = Json::array();
    if (scene.contains("constraints"))
      for (const Json& c : scene["constraints"])
        if (c["body"] == b.name) held.push_back(c["where"]);
    if (!held.empty()) {
      add("force", Json::object({{"where", Json::object({{"any_of", held}})}}));
      add("moment", Json{{"where", Json::object({{"any_of", held}})}, {"about", {row[0].from, 0.0, 0.0}}});
    }
  }
  for (const char* quantity : {"momentum", "angular_momentum", "kinetic_energy", "total_energy"})
    probes[quantity] = Json::object({{"quantity", quantity}});
}

}  // namespace fascia::random_scenes
