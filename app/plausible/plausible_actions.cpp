#include "app/plausible/plausible.hpp"
#include "assembly/specification/errors.hpp"
#include "assembly/specification/readable.hpp"
#include "core/base/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace fascia::app {
namespace {

constexpr double kStretched = 1;                   // strain that a load would cause by Hooke's law
constexpr double kUnseen = 1e-9;                   // the same of one that does nothing, slenderness included
constexpr double kBurst = 1;                       // hoop stress over Young's modulus: rubber balloons give way at 0.4
constexpr double kFast = 50, kFastForWaves = 0.2;  // [m/s]; of the speed of waves
constexpr double kOfTorque = 12, kFastSpin = 600;  // see pull_of(); [rad/s]
constexpr double kSwollen = 10;                    // volume of a fluid over that at rest
constexpr double kDrawnOut = 8;                    // way of a part over the body's size, where another part is held
constexpr double kHeavyGravity = 100, kLightGravity = 0.05;  // [m/s²]: ten times the earth's; moons have 0.1
constexpr double kThinnerThanAir = 1000;                     // [Pa] bulk modulus; air: 100 kPa

bool is_elastic(const Simulation& s, std::size_t body) { return scale_of(s, body).softest > 0; }

/// What of a load stretches the body, as a force [N], and the key that says it.
struct Pull {
  double force = 0;
  const char* key = "";
};

Pull pull_of(const Simulation& s, const Load& load, std::size_t body) {
  Pull pull;
  const BodyScale scale = scale_of(s, body);
  const auto take = [&, factor = largest_factor(load.schedule)](double force, const char* key) {
    if (factor * force > pull.force) pull = {factor * force, key};
  };
  if (load.total_force) take(norm(*load.total_force), "total_force");
  if (load.force) take(norm(*load.force), "force");
  if (load.line_force) take(norm(*load.line_force) * scale.length, "line_force");
  if (load.force_per_node && load.where)
    take(norm(*load.force_per_node) * static_cast<double>(find_nodes(s, static_cast<int>(body), *load.where).size()),
         "force_per_node");
  if (scale.thickness <= 0) return pull;
  // A round bar of section A and thickness h is sheared by 1 at its skin by a torque of G A h / 4, E / G about 3.
  if (load.total_torque) take(kOfTorque * norm(*load.total_torque) / scale.thickness, "total_torque");
  if (load.torque) take(kOfTorque * norm(*load.torque) / scale.thickness, "torque");
  return pull;
}

void warn_of_strength(Simulation& s, std::size_t index, const Load& load, std::size_t b) {
  const BodyScale scale = scale_of(s, b);
  const std::string path = fmt::format("loads[{}].", index);
  const Pull pull = pull_of(s, load, b);
  const double held = scale.area * scale.stiffest;
  const bool torque = std::string(pull.key).ends_with("torque");
  if (pull.force > kStretched * held)
    s.warnings.add(
        "load", s.scene.place_of(path + pull.key),
        fmt::format("{:.4g} {} on body \"{}\", whose mean section of {:.3g} m2 and Young's modulus of {} make "
                    "{:.4g} N at a strain of 1; write the unit, as \"5 m{}\"",
                    torque ? pull.force * scale.thickness / kOfTorque : pull.force, torque ? "N m" : "N",
                    s.bodies[b].name, scale.area, pressure_text(scale.stiffest), held, torque ? "N m" : "N"));
  const double pressure = largest_factor(load.schedule) *
                          std::max(std::abs(load.pressure.value_or(0)), norm(load.traction.value_or(Vec3d{})));
  const Place place = s.scene.place_of(path + (load.pressure ? "pressure" : "traction"));
  if (pressure > kStretched * scale.stiffest)
    s.warnings.add("load", place,
                   fmt::format("{} on body \"{}\", whose Young's modulus is {}; write the unit, as \"2 kPa\"",
                               pressure_text(pressure), s.bodies[b].name, pressure_text(scale.stiffest)));
  const double slenderness = scale.thickness > 0 ? scale.length / scale.thickness : 1;
  const double strain = std::max(held > 0 ? pull.force / held : 0, pressure / scale.softest);
  if (strain > 0 && strain * slenderness * slenderness < kUnseen)
    s.warnings.add(
        "load", pull.force > 0 ? s.scene.place_of(path + pull.key) : place,
        fmt::format("strains body \"{}\" ({}) by about {:.1e}: nothing to see; write the unit, as {}", s.bodies[b].name,
                    pressure_text(scale.stiffest), strain, pull.force > 0 ? "\"5 kN\"" : "\"2 kPa\""));
}

/// A thin wall holds no pressure whose hoop stress, p R / t, comes near its modulus.
void warn_of_burst(Simulation& s, std::size_t b, double pressure, const Place& place) {
  if (s.scene.bodies[b].thickness.empty()) return;
  const BodyScale scale = scale_of(s, b);
  std::array<double, 3> extents{scale.extent[0], scale.extent[1], scale.extent[2]};
  std::sort(extents.begin(), extents.end());
  const double radius = extents[1] / 2, stress = std::abs(pressure) * radius / scale.thickness;
  if (stress > kBurst * scale.stiffest)
    s.warnings.add("load", place,
                   fmt::format("{} strains the wall of body \"{}\" ({} thick, {} across, {}) by more than 1: it "
                               "bursts; write the unit, as \"13 kPa\", or see its thickness",
                               pressure_text(std::abs(pressure)), s.bodies[b].name, length_text(scale.thickness),
                               length_text(2 * radius), pressure_text(scale.stiffest)));
}

void warn_of_fluid(Simulation& s, std::size_t b) {
  const std::optional<Fluid>& fluid = s.scene.bodies[b].fluid;
  if (!fluid) return;
  if (fluid->pressure)
    warn_of_burst(s, b, *fluid->pressure * largest_factor(fluid->schedule),
                  s.scene.place_of(fluid->place.key + ".pressure"));
  const auto of_body = [&](const FluidOfBody& f) { return at(f.body) == b; };
  const auto built = std::find_if(s.fluids.begin(), s.fluids.end(), of_body);
  if (fluid->volume && built != s.fluids.end()) {
    const double rest = s.model.surfaces[at(built->surface)].rest_volume, ratio = *fluid->volume / rest;
    if (ratio > kSwollen || ratio < 1 / kSwollen)
      s.warnings.add("load", s.scene.place_of(fluid->place.key + ".volume"),
                     fmt::format("{} in body \"{}\", which holds {} at rest; write the unit, as \"250 ml\"",
                                 volume_text(*fluid->volume), s.bodies[b].name, volume_text(rest)));
  }
  if (fluid->bulk_modulus && *fluid->bulk_modulus < kThinnerThanAir)
    s.warnings.add("load", s.scene.place_of(fluid->place.key + ".bulk_modulus"),
                   fmt::format("{} is softer than air (100 kPa), and resists nothing; write the unit, as \"2.2 GPa\" "
                               "of water",
                               pressure_text(*fluid->bulk_modulus)));
}

void warn_of_speed(Simulation& s, std::size_t b, double speed, const Place& place) {
  const BodyScale scale = scale_of(s, b);
  if (speed <= std::max(kFast, kFastForWaves * scale.wave_speed())) return;
  s.warnings.add("velocity", place,
                 fmt::format("{:.4g} m/s, where waves pass through body \"{}\" at {:.3g} m/s; write the unit, as "
                             "\"0.5 m/s\", or a longer over",
                             speed, s.bodies[b].name, scale.wave_speed()));
}

/// More than a turn by an angle that is a round one in no unit but degrees.
bool is_angle_in_degrees(double angle) {
  constexpr double kRound = std::numbers::pi / 12;
  return std::abs(angle) > 2.001 * std::numbers::pi && std::abs(std::remainder(angle, kRound)) > 1e-6 * kRound;
}

/// The middle of the nodes that a region selects.
Vec3d middle_of(const Simulation& s, int body, const Region& region) {
  const std::vector<int> nodes = find_nodes(s, body, region);
  Vec3d sum{};
  for (const int node : nodes) sum += s.model.rest_position[at(node)];
  return sum * (1 / static_cast<double>(std::max<std::size_t>(1, nodes.size())));
}

void warn_of_motion(Simulation& s, std::size_t index) {
  const Constraint& c = s.scene.constraints[index];
  const std::string move = fmt::format("constraints[{}].move.", index);
  const auto b = static_cast<std::size_t>(body_index(s, c.body));
  if (is_angle_in_degrees(c.motion->angle))
    s.warnings.add("load", s.scene.place_of(move + "rotate.angle"),
                   fmt::format("turns by {:.4g} rad, {:.3g} times round; write the unit, as \"{:.4g} degree\"",
                               c.motion->angle, c.motion->angle / (2 * std::numbers::pi), c.motion->angle));
  if (!is_elastic(s, b)) return;
  const double way = norm(c.motion->translate) * largest_factor(c.schedule), size = s.bodies[b].body->size();
  const Vec3d moved = middle_of(s, static_cast<int>(b), c.where);
  const auto holds = [&](const Constraint& other) {
    return other.body == c.body && !other.motion && other.fixed[0] && other.fixed[1] && other.fixed[2];
  };
  const auto is_drawn_from = [&](const Constraint& other) {
    return holds(other) &&
           way > kDrawnOut * std::max(size / 4, norm(middle_of(s, static_cast<int>(b), other.where) - moved));
  };
  const auto is_pushed_through = [&](const Constraint& other) {
    if (!holds(other)) return false;
    const Vec3d apart = middle_of(s, static_cast<int>(b), other.where) - moved;
    return dot(c.motion->translate, apart) * largest_factor(c.schedule) > squared_norm(apart) && way > size / 100;
  };
  if (std::any_of(s.scene.constraints.begin(), s.scene.constraints.end(), is_pushed_through))
    s.warnings.add("load", s.scene.place_of(move + "translate"),
                   fmt::format("pushes this end of body \"{}\" by {}, through what is held; write lengths with their "
                               "unit, as \"5 mm\"",
                               c.body, length_text(way)));
  if (std::any_of(s.scene.constraints.begin(), s.scene.constraints.end(), is_drawn_from))
    s.warnings.add("load", s.scene.place_of(move + "translate"),
                   fmt::format("draws body \"{}\", which is {} in size and held elsewhere, out by {}; write lengths "
                               "with their unit, as \"5 mm\"",
                               c.body, length_text(size), length_text(way)));
  if (c.schedule.over > 0 && grows_over(c.schedule) && is_dynamic(s.scene.solver.kind))
    warn_of_speed(s, b, way / c.schedule.over, s.scene.place_of(move + "translate"));
}

void warn_of_spin(Simulation& s, std::size_t b) {
  const double spin = norm(s.scene.bodies[b].initial.angular_velocity);
  if (spin > kFastSpin)
    s.warnings.add("velocity", s.scene.place_of("bodies." + s.bodies[b].name + ".initial.angular_velocity"),
                   fmt::format("{:.4g} rad/s, {:.3g} turns a second; write the unit, as \"{:.4g} degree/s\"", spin,
                               spin / (2 * std::numbers::pi), spin));
}

void warn_of_initial_motion(Simulation& s, std::size_t b) {
  const InitialMotion& initial = s.scene.bodies[b].initial;
  const std::string path = "bodies." + s.bodies[b].name + ".initial.";
  warn_of_speed(s, b, norm(initial.velocity), s.scene.place_of(path + "velocity"));
  warn_of_speed(s, b, norm(initial.angular_velocity) * scale_of(s, b).length / 2,
                s.scene.place_of(path + "angular_velocity"));
}

void warn_of_gravity(Simulation& s) {
  const double g = norm(s.scene.world.gravity);
  if (g == 0 || (g >= kLightGravity && g <= kHeavyGravity)) return;
  s.warnings.add(
      "load", s.scene.place_of("world.gravity"),
      fmt::format("{:.4g} m/s2, {:.3g} times the earth's; write 9.81, or the unit, as \"9.81 m/s2\"", g, g / 9.81));
}

}  // namespace

void warn_of_loads(Simulation& s) {
  warn_of_gravity(s);
  for (std::size_t i = 0; i < s.scene.loads.size(); ++i) {
    const Load& load = s.scene.loads[i];
    const auto b = static_cast<std::size_t>(body_index(s, load.body));
    if (!is_elastic(s, b)) continue;
    warn_of_strength(s, i, load, b);
    if (load.pressure &&
        std::abs(*load.pressure) * largest_factor(load.schedule) <= kStretched * scale_of(s, b).stiffest)
      warn_of_burst(s, b, *load.pressure * largest_factor(load.schedule),
                    s.scene.place_of(fmt::format("loads[{}].pressure", i)));
  }
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    warn_of_spin(s, b);
    if (!is_elastic(s, b)) continue;
    warn_of_initial_motion(s, b);
    warn_of_fluid(s, b);
  }
  for (std::size_t i = 0; i < s.scene.constraints.size(); ++i)
    if (s.scene.constraints[i].motion) warn_of_motion(s, i);
}

}  // namespace fascia::app
