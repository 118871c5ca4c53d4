#include "app/plausible.hpp"
#include "app/readable.hpp"
#include "core/math/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace fascia::app {
namespace {

constexpr double kStretched = 3;                          // strain that a load would cause by Hooke's law
constexpr double kFast = 50, kFastForWaves = 0.2;         // [m/s]; of the speed of waves
constexpr double kStiffSpring = 1e5, kSoftSpring = 1e-7;  // of the body's own stiffness E A / L
constexpr double kIdleSpring = 1.0 / 500;                 // of another one on the same body
constexpr double kApart = 0.25;                           // of a body's size
constexpr double kOverdampedByMass = 1000;                // likewise; settling a body takes up to a hundred
constexpr double kOverdamped = 50;                        // damping ratio of the slowest mode
constexpr double kMostSteps = 2e7, kMostExplicitSteps = 1e9;
constexpr double kNothingYet = 0.01;  // of a wave's way through a body, of a load's growth

bool is_elastic(const Simulation& s, std::size_t body) { return scale_of(s, body).softest > 0; }

/// What of a load stretches the body, as a force [N], and the key that says it.
struct Pull {
  double force = 0;
  const char* key = "";
};

Pull pull_of(const Simulation& s, const Load& load, std::size_t body) {
  Pull pull;
  const auto take = [&](double force, const char* key) {
    if (force > pull.force) pull = {force, key};
  };
  if (load.total_force) take(norm(*load.total_force), "total_force");
  if (load.force) take(norm(*load.force), "force");
  if (load.force_per_node && load.where)
    take(norm(*load.force_per_node) * static_cast<double>(find_nodes(s, static_cast<int>(body), *load.where).size()),
         "force_per_node");
  return pull;
}

void warn_of_strength(Simulation& s, std::size_t index, const Load& load, std::size_t b) {
  const BodyScale scale = scale_of(s, b);
  const std::string path = fmt::format("loads[{}].", index);
  const Pull pull = pull_of(s, load, b);
  const double held = scale.area * scale.stiffest;
  if (pull.force > kStretched * held)
    s.warnings.add(
        "load", s.scene.place_of(path + pull.key),
        fmt::format("{:.4g} N on body \"{}\", whose mean section of {:.3g} m2 and Young's modulus of {} make "
                    "{:.4g} N at a strain of 1; write the unit, as \"5 mN\"",
                    pull.force, s.bodies[b].name, scale.area, pressure_text(scale.stiffest), held));
  const double pressure = std::max(std::abs(load.pressure.value_or(0)), norm(load.traction.value_or(Vec3d{})));
  if (pressure > kStretched * scale.stiffest)
    s.warnings.add("load", s.scene.place_of(path + (load.pressure ? "pressure" : "traction")),
                   fmt::format("{} on body \"{}\", whose Young's modulus is {}; write the unit, as \"2 kPa\"",
                               pressure_text(pressure), s.bodies[b].name, pressure_text(scale.stiffest)));
}

void warn_of_speed(Simulation& s, std::size_t b, double speed, const Place& place) {
  const BodyScale scale = scale_of(s, b);
  if (speed <= std::max(kFast, kFastForWaves * scale.wave_speed())) return;
  s.warnings.add("velocity", place,
                 fmt::format("{:.4g} m/s, where waves pass through body \"{}\" at {:.3g} m/s; write the unit, as "
                             "\"0.5 m/s\", or a longer over",
                             speed, s.bodies[b].name, scale.wave_speed()));
}

/// Nothing else than one spring bears a body.
bool hangs_on_springs(const Scene& scene, const std::string& body) {
  const auto holds = [&](const Constraint& c) { return c.body == body; };
  const auto concerns = [&](const Coupling& c) { return c.body == body || c.to == body; };
  return std::none_of(scene.constraints.begin(), scene.constraints.end(), holds) &&
         std::count_if(scene.couplings.begin(), scene.couplings.end(), concerns) == 1;
}

void warn_of_springs(Simulation& s) {
  for (const Coupling& c : s.scene.couplings) {
    const auto b = static_cast<std::size_t>(body_index(s, c.body));
    if (c.kind != CouplingKind::spring || !is_elastic(s, b)) continue;
    const BodyScale scale = scale_of(s, b);
    const double own = scale.stiffest * scale.area / scale.length, ratio = c.stiffness / own;
    if (ratio > kStiffSpring || ratio < kSoftSpring)
      s.warnings.add("spring", s.scene.place_of("couplings." + c.name + ".stiffness"),
                     fmt::format("{:.4g} N/m, {:.1e} of what stretches body \"{}\" ({:.4g} N/m); write the unit, as "
                                 "\"50 N/m\"",
                                 c.stiffness, ratio, s.bodies[b].name, own));
    for (const Coupling& other : s.scene.couplings)
      if (other.kind == CouplingKind::spring && other.body == c.body && c.stiffness < kIdleSpring * other.stiffness)
        s.warnings.add("spring", s.scene.place_of("couplings." + c.name + ".stiffness"),
                       fmt::format("{:.4g} N/m does next to nothing beside couplings.{}, {:.4g} N/m, on the same body; "
                                   "write the unit, as \"0.2 N/mm\"",
                                   c.stiffness, other.name, other.stiffness));
    const double sag = norm(s.scene.world.gravity) * s.bodies[b].body->mass() / c.stiffness;
    if (hangs_on_springs(s.scene, c.body) && sag > s.bodies[b].body->size())
      s.warnings.add("spring", s.scene.place_of("couplings." + c.name + ".stiffness"),
                     fmt::format("{:.4g} N/m: body \"{}\" ({}) hangs {} below where it is drawn; write the unit, as "
                                 "\"0.2 N/mm\"",
                                 c.stiffness, c.body, mass_text(s.bodies[b].body->mass()), length_text(sag)));
  }
}

void warn_of_gaps(Simulation& s) {
  for (std::size_t k = 0; k < s.scene.couplings.size(); ++k) {
    const Coupling& c = s.scene.couplings[k];
    if (c.kind == CouplingKind::spring) continue;
    const ModelBody& own = *s.bodies[at(body_index(s, c.body))].body;
    const ModelBody& other = *s.bodies[at(body_index(s, c.to))].body;
    double gap = 0;
    for (const int node : s.couplings[k].nodes) gap = std::max(gap, other.distance(s.model.rest_position[at(node)]));
    if (gap > kApart * own.size())
      s.warnings.add("apart", s.scene.place_of("couplings." + c.name + ".where"),
                     fmt::format("takes nodes up to {} away from \"{}\"; take those beside it, or move one of the two",
                                 length_text(gap), c.to));
  }
}

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
      const auto by = std::find_if(s.scene.constraints.begin(), s.scene.constraints.end(),
                                   [&](const Constraint& c) { return c.body == s.bodies[b].name; });
      const auto number = by - s.scene.constraints.begin();
      s.warnings.add("held", s.scene.place_of(fmt::format("constraints[{}].where", number)),
                     fmt::format("holds all {} {}s of body \"{}\", which cannot move; take fewer, or model = \"rigid\"",
                                 s.bodies[b].node_ids.size(), s.bodies[b].node_word(), s.bodies[b].name));
    }
  for (std::size_t l = 0; l < s.scene.loads.size(); ++l) {
    const Load& load = s.scene.loads[l];
    if (load.where && !load.pressure && !load.traction &&
        all_fixed(find_nodes(s, body_index(s, load.body), *load.where)))
      s.warnings.add("no-effect", s.scene.place_of(fmt::format("loads[{}].where", l)),
                     "takes nodes that are all held: the load moves nothing");
  }
}

/// A schedule of the scene with the table that it stands in.
struct NamedSchedule {
  std::string table;
  const Schedule* schedule;
};

std::vector<NamedSchedule> schedules_of(const Scene& scene) {
  std::vector<NamedSchedule> all{{"world", &scene.world.schedule}};
  for (std::size_t i = 0; i < scene.constraints.size(); ++i)
    all.push_back({fmt::format("constraints[{}]", i), &scene.constraints[i].schedule});
  for (std::size_t i = 0; i < scene.loads.size(); ++i)
    all.push_back({fmt::format("loads[{}]", i), &scene.loads[i].schedule});
  for (const Body& b : scene.bodies)
    if (b.fluid) all.push_back({"bodies." + b.name + ".fluid", &b.fluid->schedule});
  return all;
}

void warn_of_coarse_times(Simulation& s, const NamedSchedule& named) {
  const Solver& solver = s.scene.solver;
  const Schedule& schedule = *named.schedule;
  const Place place = s.scene.place_of("solver.time_step");
  if (const auto* sine = std::get_if<SineProfile>(&schedule.profile); sine && solver.time_step > sine->period / 4)
    s.warnings.add("time-step", place,
                   fmt::format("{} is more than a quarter of the period of {}.profile, {}", time_text(solver.time_step),
                               named.table, time_text(sine->period)));
  if (!schedule.has_over || schedule.over <= 0) return;
  if (solver.time_step > schedule.over * 1.001)
    s.warnings.add("time-step", place,
                   fmt::format("{} is longer than {}.over, {}: all of it happens within one step",
                               time_text(solver.time_step), named.table, time_text(schedule.over)));
  if (solver.duration && *solver.duration < kNothingYet * schedule.over)
    s.warnings.add("duration", s.scene.place_of("solver.duration"),
                   fmt::format("{} ends when {}, over {}, has hardly begun", time_text(*solver.duration), named.table,
                               time_text(schedule.over)));
}

void warn_of_damping(Simulation& s) {
  std::set<std::string> told;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const double period = scale_of(s, b).slowest_period();
    for (const MaterialUse& use : s.scene.bodies[b].materials) {
      const Material& m = use.material;
      if (period <= 0 || !told.insert(m.place.key).second) continue;
      const double omega = 2 * std::numbers::pi / period;
      const double of_mass = m.mass_damping / (2 * omega), of_stiffness = m.stiffness_damping * omega / 2;
      const bool mass = of_mass > kOverdampedByMass;
      if (!mass && of_stiffness < kOverdamped) continue;
      s.warnings.add(
          "damping", place_of_material(s.scene, m, mass ? "damping.mass" : "damping.stiffness"),
          fmt::format("is {:.2g} times what stops the slowest vibration of body \"{}\" (about {}): it creeps; "
                      "usual are {}",
                      mass ? of_mass : of_stiffness, s.bodies[b].name, time_text(period),
                      mass ? "0.1 to 10 1/s" : "\"1 ms\" to \"50 ms\""));
    }
  }
}

}  // namespace

void warn_of_loads(Simulation& s) {
  for (std::size_t i = 0; i < s.scene.loads.size(); ++i) {
    const auto b = static_cast<std::size_t>(body_index(s, s.scene.loads[i].body));
    if (is_elastic(s, b)) warn_of_strength(s, i, s.scene.loads[i], b);
  }
  for (std::size_t b = 0; b < s.bodies.size(); ++b)
    if (is_elastic(s, b))
      warn_of_speed(s, b, norm(s.scene.bodies[b].initial.velocity),
                    s.scene.place_of("bodies." + s.bodies[b].name + ".initial.velocity"));
  for (std::size_t i = 0; i < s.scene.constraints.size(); ++i) {
    const Constraint& c = s.scene.constraints[i];
    const auto b = static_cast<std::size_t>(body_index(s, c.body));
    if (c.motion && c.schedule.over > 0 && is_dynamic(s.scene.solver.kind) && is_elastic(s, b))
      warn_of_speed(s, b, norm(c.motion->translate) / c.schedule.over,
                    s.scene.place_of(fmt::format("constraints[{}].move.translate", i)));
  }
  warn_of_springs(s);
  warn_of_gaps(s);
}

void warn_of_times(Simulation& s) {
  const Solver& solver = s.scene.solver;
  if (!is_dynamic(solver.kind)) return;
  const double duration = solver.duration.value_or(solver.steps * solver.time_step);
  if (is_implicit_dynamics(solver.kind))
    for (const NamedSchedule& named : schedules_of(s.scene)) warn_of_coarse_times(s, named);
  double slowest = 0, crossing = 0;
  std::string slow_body;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const BodyScale scale = scale_of(s, b);
    if (scale.slowest_period() > slowest) slow_body = s.bodies[b].name;
    slowest = std::max(slowest, scale.slowest_period());
    const double across = scale.wave_speed() > 0 ? scale.length / scale.wave_speed() : 0;
    crossing = crossing > 0 && across > 0 ? std::min(crossing, across) : std::max(crossing, across);
  }
  if (is_implicit_dynamics(solver.kind) && slowest > 0 && solver.time_step > slowest && solver.time_step > 0)
    s.warnings.add("time-step", s.scene.place_of("solver.time_step"),
                   fmt::format("{} is longer than the slowest vibration of body \"{}\" (about {}): no vibration is "
                               "resolved; use a shorter step, or kind = \"static\"",
                               time_text(solver.time_step), slow_body, time_text(slowest)));
  // Explicit runs may be about waves alone.
  const bool falls = is_implicit_dynamics(solver.kind) && squared_norm(s.scene.world.gravity) > 0;
  if (falls && duration < kNothingYet * slowest)
    s.warnings.add("duration", s.scene.place_of(s.scene.says("solver.duration") ? "solver.duration" : "solver.steps"),
                   fmt::format("{} is next to nothing of the slowest vibration of body \"{}\" (about {}): it hardly "
                               "moves",
                               time_text(duration), slow_body, time_text(slowest)));
  else if (duration < kNothingYet * crossing)
    s.warnings.add("duration", s.scene.place_of(s.scene.says("solver.duration") ? "solver.duration" : "solver.steps"),
                   fmt::format("{} ends long before a wave has crossed a body ({}): nothing happens",
                               time_text(duration), time_text(crossing)));
  const double most = is_implicit_dynamics(solver.kind) ? kMostSteps : kMostExplicitSteps;
  if (solver.steps > most)
    s.warnings.add("duration", s.scene.place_of("solver.time_step"),
                   fmt::format("makes {:.3g} steps; use a longer time_step or a shorter duration",
                               static_cast<double>(solver.steps)));
  warn_of_damping(s);
}

void warn_of_no_effect(Simulation& s) {
  const bool statics = s.scene.solver.kind == SolverKind::statics;
  for (const NamedSchedule& named : schedules_of(s.scene)) {
    const std::string over = named.table + ".over";
    if (!s.scene.says(over)) continue;
    const bool linear = std::holds_alternative<LinearProfile>(named.schedule->profile) ||
                        std::holds_alternative<SmoothProfile>(named.schedule->profile);
    if (!linear)
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
      if (used.insert(m.place.key).second && !is_dynamic(s.scene.solver.kind) &&
          m.mass_damping + m.stiffness_damping > 0)
        s.warnings.add("no-effect", place_of_material(s.scene, m, "damping"),
                       "does nothing without time; remove it, or use a dynamic solver");
    }
  for (const auto& [key, place] : s.scene.places)
    if (key.starts_with("materials.") && key.find('.', 10) == std::string::npos && !used.contains(key))
      s.warnings.add("no-effect", place, "no body is made of it; name it as material, or remove it");
  warn_of_held(s, fixed_nodes(s));
}

}  // namespace fascia::app
