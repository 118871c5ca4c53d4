#include "app/plausible/plausible.hpp"
#include "core/base/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace fascia::app {
namespace {

/// Nodes that do not move at all.
std::set<int> fixed_nodes(const Simulation& s) {
  std::set<int> fixed;
  for (const FrameConstraint& c : s.model.constraints) {
    const auto still = [](int motion) { return motion < 0; };
    if (c.translations == 3 && (c.rotations == 3 || c.whole || s.model.kind(c.node) == FrameKind::vertex) &&
        std::all_of(c.translation_motion.begin(), c.translation_motion.end(), still) &&
        std::all_of(c.rotation_motion.begin(), c.rotation_motion.end(), still))
      fixed.insert(c.node);
  }
  return fixed;
}

void warn_of_held(Simulation& s, const std::set<int>& fixed) {
  const auto all_fixed = [&](const std::vector<int>& nodes) {
    return !nodes.empty() && std::all_of(nodes.begin(), nodes.end(), [&](int n) { return fixed.contains(n); });
  };
  for (std::size_t b = 0; b < s.bodies.size(); ++b)
    if (!is_carrier(s.scene.bodies[b]) && all_fixed(s.bodies[b].node_ids)) {
      const std::vector<Constraint>& all = s.scene.constraints;
      const auto on_it = [&](const Constraint& c) { return c.body == s.bodies[b].name; };
      const auto by = std::find_if(all.begin(), all.end(), on_it);
      const bool single = std::count_if(all.begin(), all.end(), on_it) == 1;
      s.warnings.add(
          "held",
          single ? s.scene.place_of(fmt::format("constraints[{}].where", by - all.begin())) : s.scene.bodies[b].place,
          fmt::format("{} all {} {}s of body \"{}\", which cannot move; take fewer, or model = \"rigid\"",
                      single ? "holds" : "constraints hold", s.bodies[b].node_ids.size(), s.bodies[b].node_word(),
                      s.bodies[b].name));
    }
  for (std::size_t l = 0; l < s.scene.loads.size(); ++l) {
    const Load& load = s.scene.loads[l];
    if (load.where && !load.pressure && !load.traction &&
        all_fixed(find_nodes(s, body_index(s, load.body), *load.where)))
      s.warnings.add("no-effect", s.scene.place_of(fmt::format("loads[{}].where", l)),
                     "takes nodes that are all held: the load moves nothing");
  }
}

void warn_of_idle_viscosity(Simulation& s, const Material& m) {
  const SolverKind kind = s.scene.solver.kind;
  if (kind == SolverKind::modes)
    s.warnings.add("no-effect", place_of_material(s.scene, m, "viscosity"),
                   "does nothing to natural frequencies, which are those of the instantaneous constants; remove it, or "
                   "give the constants of the long term");
  if (kind != SolverKind::statics && s.scene.says(m.place.key + ".statics"))
    s.warnings.add("no-effect", place_of_material(s.scene, m, "statics"),
                   "does nothing where the solver is not static; remove it");
}

/// Keys that ask for more than the scene has.
void warn_of_absent(Simulation& s) {
  const auto& fields = s.scene.output.fields;
  const bool turns = std::any_of(s.bodies.begin(), s.bodies.end(), [](const SimulatedBody& b) { return !b.vertices; });
  if (!turns && std::find(fields.begin(), fields.end(), "rotation") != fields.end() && s.scene.says("output.fields"))
    s.warnings.add("no-effect", s.scene.place_of("output.fields"),
                   "names \"rotation\", which bodies of elements do not have; remove it");
  const int free = s.model.free_dof_count(), asked = s.scene.solver.modes;
  if (s.scene.solver.kind == SolverKind::modes && asked > free && s.scene.says("solver.count"))
    s.warnings.add(
        "no-effect", s.scene.place_of("solver.count"),
        fmt::format("asks for {} modes of a model with {} unknowns, which has no more of them", asked, free));
}

}  // namespace

void warn_of_no_effect(Simulation& s) {
  const bool statics = s.scene.solver.kind == SolverKind::statics;
  for (const NamedSchedule& named : schedules_of(s.scene)) {
    const std::string over = named.table + ".over";
    if (!s.scene.says(over)) continue;
    if (!grows_over(*named.schedule))
      s.warnings.add("no-effect", s.scene.place_of(over),
                     "does nothing beside this profile, which has its own times; remove it");
    else if (statics)
      s.warnings.add(
          "no-effect", s.scene.place_of(over),
          "does nothing in a static solve, where all grows with the load factor; remove it, or use a dynamic "
          "solver");
  }
  std::set<std::string> used;
  for (const Body& b : s.scene.bodies)
    for (const MaterialUse& use : b.materials) {
      const Material& m = use.material;
      const bool fresh = used.insert(m.place.key).second;
      if (fresh && !is_dynamic(s.scene.solver.kind) && m.mass_damping + m.stiffness_damping > 0)
        s.warnings.add("no-effect", place_of_material(s.scene, m, "damping"),
                       "does nothing without time; remove it, or use a dynamic solver");
      if (fresh && m.viscosity) warn_of_idle_viscosity(s, m);
    }
  for (const auto& [key, place] : s.scene.places)
    if (key.starts_with("materials.") && key.find('.', 10) == std::string::npos && !used.contains(key))
      s.warnings.add("no-effect", place, "no body is made of it; name it as material, or remove it");
  warn_of_held(s, fixed_nodes(s));
  warn_of_absent(s);
}

}  // namespace fascia::app
