#include "app/plausible/plausible.hpp"
#include "assembly/specification/readable.hpp"
#include "assembly/specification/schedule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace fascia::app {
namespace {

constexpr double kOverdamped = 50, kOverdampedByMass = 20, kLittleWay = 0.2;  // damping ratio of the slowest mode
constexpr double kMostSteps = 2e7, kMostExplicitSteps = 1e9;
constexpr double kNothingYet = 0.01;  // of a wave's way through a body
constexpr double kLoose = 0.05;       // Newton's tolerance
constexpr double kFallen = 500;       // of a body's length
constexpr double kHardlyGrown = 0.1;  // of a load's growth
constexpr double kCoarse = 0.5;       // of the slowest period

/// The largest absolute value that a table takes until a time.
double largest_factor_until(const Schedule& schedule, double time) {
  double largest = std::abs(schedule_factor(schedule, time, false));
  for (const auto& [when, factor] : std::get<TableProfile>(schedule.profile).points)
    if (when <= time) largest = std::max(largest, std::abs(factor));
  return largest;
}

void warn_of_late_times(Simulation& s, const NamedSchedule& named, double duration) {
  const auto* table = std::get_if<TableProfile>(&named.schedule->profile);
  if (table == nullptr) return;
  const double reached = largest_factor_until(*named.schedule, duration), most = largest_factor(*named.schedule);
  if (reached < kHardlyGrown * most)
    s.warnings.add(
        "duration", s.scene.place_of(named.table + ".profile"),
        fmt::format("reaches {:.2g} of its largest factor, {:.4g}, within the run, {}; its times are seconds",
                    reached / most, most, time_text(duration)));
}

void warn_of_coarse_times(Simulation& s, const NamedSchedule& named) {
  const Solver& solver = s.scene.solver;
  const Schedule& schedule = *named.schedule;
  const Place place = s.scene.place_of("solver.time_step");
  if (const auto* sine = std::get_if<SineProfile>(&schedule.profile); sine && solver.time_step > sine->period / 4)
    s.warnings.add("time-step", place,
                   fmt::format("{} is more than a quarter of the period of {}.profile, {}", time_text(solver.time_step),
                               named.table, time_text(sine->period)));
  if (!schedule.has_over || schedule.over <= 0 || !grows_over(schedule)) return;
  if (solver.time_step > schedule.over * 1.001)
    s.warnings.add("time-step", place,
                   fmt::format("{} is longer than {}.over, {}: all of it happens within one step",
                               time_text(solver.time_step), named.table, time_text(schedule.over)));
  if (solver.duration && *solver.duration < kHardlyGrown * schedule.over)
    s.warnings.add("duration", s.scene.place_of("solver.duration"),
                   fmt::format("{} ends when {}, over {}, has hardly begun; use a longer duration or a shorter over",
                               time_text(*solver.duration), named.table, time_text(schedule.over)));
}

/// How the damping of a material slows a body down, where it creeps to where it would swing.
struct Creep {
  double ratio = 0;      ///< of damping, of the slowest vibration; above 1 nothing swings
  double time = 0;       ///< that it takes to come near its end [s]
  bool of_mass = false;  ///< rather than of stiffness
};

Creep creep_of(const Material& m, double period) {
  if (period <= 0) return {};
  const double omega = 2 * std::numbers::pi / period;
  const double of_mass = m.mass_damping / (2 * omega), of_stiffness = m.stiffness_damping * omega / 2;
  if (of_mass > of_stiffness) return {of_mass, m.mass_damping / (omega * omega), true};
  return {of_stiffness, m.stiffness_damping, false};
}

/// What gravity and the loads of a body accelerate it by [m/s²].
double acceleration_of(const Simulation& s, std::size_t b) {
  double force = norm(s.scene.world.gravity) * s.bodies[b].body->mass();
  for (const Load& load : s.scene.loads)
    if (load.body == s.bodies[b].name)
      force += largest_factor(load.schedule) *
               (norm(load.total_force.value_or(Vec3d{})) + norm(load.force.value_or(Vec3d{})));
  return s.bodies[b].body->mass() > 0 ? force / s.bodies[b].body->mass() : 0;
}

/// Damping keeps a body from getting anywhere within the run: what creeps, and gets there in time, may be meant.
bool stands_still(const Simulation& s, std::size_t b, const Material& m, const Creep& creep, double duration) {
  if (creep.time < duration) return false;
  if (!creep.of_mass) return creep.ratio > kOverdamped;
  const double way = acceleration_of(s, b) * duration / m.mass_damping;
  return creep.ratio > kOverdampedByMass && way < kLittleWay * scale_of(s, b).length;
}

void warn_of_damping(Simulation& s, double duration) {
  std::set<std::string> told;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const double period = scale_of(s, b).slowest_period();
    for (const MaterialUse& use : s.scene.bodies[b].materials) {
      const Material& m = use.material;
      const Creep creep = creep_of(m, period);
      if (!stands_still(s, b, m, creep, duration) || !told.insert(m.place.key).second) continue;
      s.warnings.add(
          "damping", place_of_material(s.scene, m, creep.of_mass ? "damping.mass" : "damping.stiffness"),
          fmt::format(
              "is {:.2g} times what stops the slowest vibration of body \"{}\" (about {}): it creeps, and takes "
              "{}, longer than the run; usual are {}",
              creep.ratio, s.bodies[b].name, time_text(period), time_text(creep.time),
              creep.of_mass ? "0.1 to 10 1/s" : "\"1 ms\" to \"50 ms\""));
    }
  }
}

/// A stress of the material fades over steps, and the run may be about that.
bool fades_in_steps(const Material& m, double time_step, double duration) {
  const auto fades = [&](const ViscousBranch& branch) {
    return branch.time >= time_step && branch.time <= 10 * duration && branch.share >= 0.01;
  };
  return m.viscosity && std::any_of(m.viscosity->branches.begin(), m.viscosity->branches.end(), fades);
}

/// The body that vibrates most slowly, and the shortest time in which a wave crosses one.
struct Vibrations {
  double slowest = 0, crossing = 0;  ///< [s]; 0: none
  double length = 0;                 ///< of the slowest body [m]
  bool creeps = false;               ///< the slowest body does, or relaxes, and so the run may be about that
  std::string body;
};

Vibrations vibrations_of(const Simulation& s, double duration) {
  Vibrations v;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const BodyScale scale = scale_of(s, b);
    const double period = scale.slowest_period();
    const auto creeps = [&](const MaterialUse& use) {
      return creep_of(use.material, period).ratio > 1 ||
             fades_in_steps(use.material, s.scene.solver.time_step, duration);
    };
    const std::vector<MaterialUse>& materials = s.scene.bodies[b].materials;
    if (period > v.slowest) {
      v.slowest = period;
      v.length = scale.length;
      v.body = s.bodies[b].name;
      v.creeps = std::any_of(materials.begin(), materials.end(), creeps);
    }
    const double across = scale.wave_speed() > 0 ? scale.length / scale.wave_speed() : 0;
    v.crossing = v.crossing > 0 && across > 0 ? std::min(v.crossing, across) : std::max(v.crossing, across);
  }
  return v;
}

/// Nothing holds, ties or drives a body, and it falls out of sight.
void warn_of_falls(Simulation& s, double fall) {
  const Scene& scene = s.scene;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const std::string& name = s.bodies[b].name;
    const auto on_it = [&](const auto& action) { return action.body == name; };
    const auto ties_it = [&](const Coupling& c) { return c.body == name || c.to == name; };
    const auto shares = [](const SimulatedBody& other) { return !other.body->shared_nodes().empty(); };
    if (fall < kFallen * scale_of(s, b).length || std::any_of(s.bodies.begin(), s.bodies.end(), shares) ||
        std::any_of(scene.constraints.begin(), scene.constraints.end(), on_it) ||
        std::any_of(scene.loads.begin(), scene.loads.end(), on_it) ||
        std::any_of(scene.couplings.begin(), scene.couplings.end(), ties_it))
      continue;
    s.warnings.add("held", scene.bodies[b].place,
                   fmt::format("falls by {}: nothing holds it, and world.gravity acts; add a constraint or a coupling",
                               length_text(fall)));
  }
}

void warn_of_duration(Simulation& s, double duration, const Vibrations& v) {
  const Solver& solver = s.scene.solver;
  const Place place = s.scene.place_of(s.scene.says("solver.duration") ? "solver.duration" : "solver.steps");
  // Explicit runs may be about waves alone.
  const double fall = 0.5 * norm(s.scene.world.gravity) * duration * duration;
  const bool falls = is_implicit_dynamics(solver.kind) && fall > 0;
  if (falls && duration < kNothingYet * v.slowest && fall < kNothingYet * v.length)
    s.warnings.add("duration", place,
                   fmt::format("{} is next to nothing of the slowest vibration of body \"{}\" (about {}): it hardly "
                               "moves",
                               time_text(duration), v.body, time_text(v.slowest)));
  else if (duration < kNothingYet * v.crossing)
    s.warnings.add("duration", place,
                   fmt::format("{} ends long before a wave has crossed a body ({}): nothing happens",
                               time_text(duration), time_text(v.crossing)));
  const double most = is_implicit_dynamics(solver.kind) ? kMostSteps : kMostExplicitSteps;
  if (solver.steps > most)
    s.warnings.add("duration", s.scene.place_of("solver.time_step"),
                   fmt::format("makes {:.3g} steps; use a longer time_step or a shorter duration",
                               static_cast<double>(solver.steps)));
}

}  // namespace

void warn_of_times(Simulation& s) {
  const Solver& solver = s.scene.solver;
  if (solver.newton_tolerance > kLoose)
    s.warnings.add("solver", s.scene.place_of("solver.newton.tolerance"),
                   fmt::format("{:g} ends steps with {:.2g} of the first residual left: that is no equilibrium; usual "
                               "are 1e-8 to 1e-4",
                               solver.newton_tolerance, solver.newton_tolerance));
  if (!is_dynamic(solver.kind)) return;
  const double duration = solver.duration.value_or(solver.steps * solver.time_step);
  if (is_implicit_dynamics(solver.kind))
    for (const NamedSchedule& named : schedules_of(s.scene)) warn_of_coarse_times(s, named);
  for (const NamedSchedule& named : schedules_of(s.scene)) warn_of_late_times(s, named, duration);
  const Vibrations v = vibrations_of(s, duration);
  // Implicit Euler and BDF2 may be taken to let a body settle.
  const bool keeps_energy = solver.kind == SolverKind::newmark || solver.kind == SolverKind::midpoint;
  if (is_implicit_dynamics(solver.kind) && v.slowest > 0 && !v.creeps &&
      solver.time_step > (keeps_energy ? kCoarse : 1) * v.slowest)
    s.warnings.add("time-step", s.scene.place_of("solver.time_step"),
                   fmt::format("{} is too long for the slowest vibration of body \"{}\" (about {}): no vibration "
                               "is resolved; use a shorter step, or kind = \"static\"",
                               time_text(solver.time_step), v.body, time_text(v.slowest)));
  warn_of_duration(s, duration, v);
  if (largest_factor(s.scene.world.schedule) > 0)
    warn_of_falls(s, 0.5 * norm(s.scene.world.gravity) * duration * duration);
  warn_of_damping(s, duration);
}

}  // namespace fascia::app
