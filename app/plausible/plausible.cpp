#include "app/plausible/plausible.hpp"

#include "app/scene/laws.hpp"
#include "assembly/specification/readable.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>

namespace fascia::app {
namespace {

// Limits, each with what lies just inside.
constexpr double kSoftest = 20, kStiffest = 1.5e12;              // [Pa] mucus and loose gels; diamond
constexpr double kLightest = 15, kHeaviest = 23000;              // [kg/m³] aerogel-like foams, lungs: 200; platinum
constexpr double kLightestOfAMass = 0.05;                        // [kg/m³] where the mass is given: scaled models
constexpr double kMetal = 4000, kSoftForAMetal = 1e9;            // [kg/m³], [Pa] lead: 11,300 and 16 GPa
constexpr double kWatery = 1300, kStiffForTissue = 3e10;         // [kg/m³], [Pa] bone: 2000 and 20 GPa
constexpr double kFoam = 700;                                    // [kg/m³] lighter bodies may be auxetic
constexpr double kSoft = 1e8;                                    // [Pa] tissue, gel, rubber
constexpr double kLongestSoft = 20, kLongest = 5000;             // [m]
constexpr double kHeaviestSoft = 5000;                           // [kg]
constexpr double kShortest = 1e-6;                               // [m]
constexpr double kTiny = 1e-4, kUsual = 0.01;                    // [m] length after and before transform.scale
constexpr double kThinnest = 5000;                               // length over thickness of soft walls
constexpr double kFar = 100, kFarForItsSize = 1000;              // [m]; of a body's length
constexpr double kLargestInertia = 10, kSmallestInertia = 1e-4;  // over mass times size squared
constexpr double kSlender = 4;                                   // length over thickness
constexpr double kSofterThanBrain = 300, kLimp = 50;             // [Pa]; see warn_of_sag()
constexpr double kCrushed = 5;                                   // weight on the base over Young's modulus

/// Weight or inertia count in what is computed.
bool mass_matters(const Scene& scene) {
  return scene.solver.kind != SolverKind::statics || squared_norm(scene.world.gravity) > 0;
}

/// A unit cube of unit stiffness and mass, as tests have it.
bool in_units_of_its_own(double young, double density) {
  constexpr double kRounding = 1e-12;
  return std::abs(young - 1) < kRounding && std::abs(density - 1) < kRounding;
}

void warn_of_stiffness(Simulation& s, const Body& body, const BodyScale& scale, std::set<std::string>& told) {
  for (const MaterialUse& use : body.materials) {
    if (!told.insert(use.material.place.key).second) continue;
    const double E = use.material.young();
    const Place place = place_of_material(s.scene, use.material, stiffness_key(use.material.law));
    if (use.material.poisson() < 0 && scale.density > kFoam)
      s.warnings.add(
          "stiffness", place_of_material(s.scene, use.material, "poisson"),
          fmt::format("{:.3g} makes body \"{}\" wider where it is stretched, as foams with folded cells are; "
                      "tissue has 0.3 to 0.5",
                      use.material.poisson(), body.name));
    if (E < kSoftest && !in_units_of_its_own(E, scale.density))
      s.warnings.add(
          "stiffness", place,
          fmt::format("{} is softer than any tissue (brain: 1 kPa, liver: 5 kPa); write the unit, as \"5 kPa\"",
                      pressure_text(E)));
    else if (E > kStiffest)
      s.warnings.add("stiffness", place,
                     fmt::format("{} is stiffer than diamond; write the unit, as \"210 GPa\"", pressure_text(E)));
    else if (scale.density > kMetal && E < kSoftForAMetal)
      s.warnings.add(
          "stiffness", place,
          fmt::format("{} is softer than any metal, and body \"{}\" as heavy as one ({:.4g} kg/m3); write the "
                      "unit, as \"210 GPa\", or another density",
                      pressure_text(E), body.name, scale.density));
    else if (scale.density > 0 && scale.density < kWatery && E > kStiffForTissue)
      s.warnings.add(
          "stiffness", place,
          fmt::format("{} is as stiff as metal, and body \"{}\" as light as tissue ({:.4g} kg/m3); write the "
                      "unit, as \"{:.4g} kPa\"",
                      pressure_text(E), body.name, scale.density, E / 1e9));
  }
}

/// @return whether the density is in the range of materials, or does not count
bool warn_of_density(Simulation& s, const Body& body, const BodyScale& scale) {
  const std::string path = "bodies." + body.name + (body.density ? ".density" : ".mass");
  const double lightest = body.density ? kLightest : kLightestOfAMass;
  if (scale.density <= 0 || (scale.density >= lightest && scale.density <= kHeaviest)) return true;
  if (!mass_matters(s.scene)) return true;
  s.warnings.add("density", s.scene.place_of(path),
                 fmt::format("makes {:.4g} kg/m3 (water: 1000, tissue: 1060, steel: 7850); write the unit, as {}",
                             scale.density, body.density ? "\"1.06 g/cm3\"" : "\"1.5 kg\""));
  return false;
}

/// The domain's file or the numbers that make it large.
Place place_of_size(const Scene& scene, const Body& body) {
  const std::string path = "bodies." + body.name;
  for (const char* key : {".transform.scale", ".domain.file", ".domain"})
    if (scene.says(path + key)) return scene.place_of(path + key);
  return body.domain_place;
}

/// The value of a key is a bare number, which stands for SI units or for those of the scene's own.
bool is_bare_number(const Scene& scene, const Place& place) {
  if (place.file == "--set" || place.line < 1) return false;
  std::istringstream lines(scene.text);
  std::string line;
  for (int i = 0; i < place.line; ++i) std::getline(lines, line);
  const std::string name = place.key.substr(place.key.rfind('.') + 1);
  const std::size_t at = line.find(name + " ");
  const std::size_t equals = at == std::string::npos ? line.find(name + "=") : line.find('=', at);
  if (equals == std::string::npos) return false;
  const std::size_t value = line.find_first_not_of("= ", equals);
  return value != std::string::npos &&
         (std::isdigit(static_cast<unsigned char>(line[value])) != 0 || line[value] == '.');
}

/// The place where the body's first material says how stiff it is.
Place place_of_stiffness(const Scene& scene, const Body& body) {
  const Material& material = body.materials.front().material;
  return place_of_material(scene, material, stiffness_key(material.law));
}

/// Without weight and inertia a scene may be in any units that agree, as published problems are.
bool may_have_units_of_its_own(const Scene& scene, const Body& body) {
  return !mass_matters(scene) && is_bare_number(scene, place_of_stiffness(scene, body));
}

/// A body far from the origin for its size.
void warn_of_distance(Simulation& s, const Body& body, const BodyScale& scale, const std::vector<Vec3d>& nodes) {
  const Bounds bounds = bounds_of(nodes);
  const double away = norm(bounds.middle());
  if (away < kFar || away < kFarForItsSize * scale.length) return;
  const std::string key = "bodies." + body.name + ".transform.translate";
  s.warnings.add("far", s.scene.says(key) ? s.scene.place_of(key) : body.domain_place,
                 fmt::format("{} from the origin, which is {:.2g} times the body's length; write lengths with their "
                             "unit, as \"160 mm\"",
                             length_text(away), away / scale.length));
}

/// A rigid body's moment of inertia is that of its mass spread over its size.
void warn_of_inertia(Simulation& s, const Body& body, const ModelBody& built) {
  if (!body.inertia || built.mass() <= 0) return;
  const double size2 = built.size() * built.size();
  const double largest = std::max({(*body.inertia)(0, 0), (*body.inertia)(1, 1), (*body.inertia)(2, 2)});
  const double ratio = largest / (built.mass() * size2);
  if (ratio < kLargestInertia && ratio > kSmallestInertia) return;
  s.warnings.add("mass", body.inertia_place,
                 fmt::format("{:.3g} kg m2 for {} of {} in size, {:.1e} of mass times size squared; write the unit, as "
                             "\"28 kg mm2\"",
                             largest, mass_text(built.mass()), length_text(built.size()), ratio));
}

/// @return whether size and mass are those of a body of such a material
bool warn_of_size(Simulation& s, const Body& body, const BodyScale& scale, double mass) {
  const bool soft = scale.softest < kSoft;
  const std::string remedy = std::holds_alternative<FileDomain>(body.domain)
                                 ? "say what a number of the file means, as domain.unit = \"mm\""
                                 : "write lengths with their unit, as \"160 mm\"";
  const Place place = place_of_size(s.scene, body);
  const std::string material = soft ? ", and its material as soft as tissue or rubber" : "";
  const bool any_units = may_have_units_of_its_own(s.scene, body);
  if (!any_units && (scale.length > (soft ? kLongestSoft : kLongest) || scale.length < kShortest))
    s.warnings.add("size", place,
                   fmt::format("the body is {} long{}; {}", length_text(scale.length), material, remedy));
  else if (soft && mass > kHeaviestSoft && mass_matters(s.scene))
    s.warnings.add(
        "mass", place,
        fmt::format("the body has a mass of {} ({}){}; {}", mass_text(mass), box_text(scale.extent), material, remedy));
  else
    return true;
  return false;
}

/// A wall of soft material that is much thinner than skin for its size. (One thicker than the body is long is told when
/// the body is built.)
void warn_of_thickness(Simulation& s, const Body& body, const BodyScale& scale) {
  if (body.thickness.empty() || scale.softest >= kSoft || scale.length <= kThinnest * scale.thickness) return;
  s.warnings.add(
      "size", body.thickness_place,
      fmt::format("{} of a body of {}, which is as soft as tissue or rubber; write lengths with their unit, as "
                  "\"2 mm\"",
                  length_text(scale.thickness), box_text(scale.extent)));
}

/// A factor for a file in millimetres on lengths that are in metres already.
bool warn_of_scale(Simulation& s, const Body& body, const BodyScale& scale) {
  const std::string key = "bodies." + body.name + ".transform.scale";
  const double before = scale.length / body.transform.scale;
  if (!s.scene.says(key) || scale.length > kTiny || before < kUsual || before > kLongestSoft) return true;
  s.warnings.add("size", s.scene.place_of(key),
                 fmt::format("makes the body {} long, which would be {} without: leave it out where lengths are in "
                             "metres already",
                             length_text(scale.length), length_text(before)));
  return false;
}

void warn_of_sag(Simulation& s, const Body& body, const BodyScale& scale) {
  if (s.scene.solver.kind == SolverKind::modes || scale.softest < kSoftest || scale.thickness <= 0) return;
  const double weight = norm(s.scene.world.gravity) * scale.density * scale.length;
  const double slenderness = scale.length / scale.thickness;
  // Sag of a cantilever by theory of small strain over its length: 3/2 of this.
  const double bent = weight / scale.softest * slenderness * slenderness;
  const bool limp = scale.softest < kSofterThanBrain && body.thickness.empty() && bent > kLimp;
  if (weight < kCrushed * scale.softest && !limp) return;
  s.warnings.add(
      "sag", place_of_stiffness(s.scene, body),
      fmt::format("{}{} does not bear body \"{}\" ({}, {:.4g} kg/m3): its own weight would {}; see {}, "
                  "density, lengths and world.gravity",
                  pressure_text(scale.softest), scale.long_term ? " in the long term" : "", body.name,
                  length_text(scale.length), scale.density, limp ? "fold it over" : "crush a column of that length",
                  stiffness_key(body.materials.front().material.law)));
}

/// One cell of frames along a body that is much longer than thick: it hardly bends.
void warn_of_single_cell(Simulation& s, const Body& body, const BodyScale& scale) {
  const auto* grid = std::get_if<GridFrames>(&body.frames);
  if (body.model != BodyModel::meshless || grid == nullptr || scale.length < kSlender * scale.thickness) return;
  for (int axis = 0; axis < 3 && grid->count.size() == 3; ++axis)
    if (grid->count[at(axis)] == 2 && scale.extent[axis] > kSlender * scale.thickness)
      s.warnings.add("locking", body.frames_place,
                     fmt::format("a single cell of frames reaches over {}, {:.2g} times the thickness: the body hardly "
                                 "bends; use 5 frames or more along {}",
                                 length_text(scale.extent[axis]), scale.extent[axis] / scale.thickness, "xyz"[axis]));
}

}  // namespace

double BodyScale::wave_speed() const { return density > 0 ? std::sqrt(stiffest / density) : 0; }

double BodyScale::slowest_period() const {
  const double c = wave_speed();
  if (c <= 0 || thickness <= 0) return 0;
  // First bending mode of a cantilever: omega = 3.52 c k / L², k = h / sqrt(12) the radius of gyration.
  const double bending = 2 * std::numbers::pi * std::sqrt(12.0) / 3.516 * length * length / (thickness * c);
  return std::max(4 * length / c, bending);
}

BodyScale scale_of(const Simulation& s, std::size_t index) {
  const Body& body = s.scene.bodies[index];
  const ModelBody& built = *s.bodies[index].body;
  BodyScale scale;
  const std::vector<Vec3d>& places = built.surface().points.empty() ? s.bodies[index].nodes : built.surface().points;
  scale.extent = bounds_of(places).extent();
  scale.length = std::max({scale.extent[0], scale.extent[1], scale.extent[2]});
  scale.thickness = std::min({scale.extent[0], scale.extent[1], scale.extent[2]});
  for (const ThicknessUse& use : body.thickness) scale.thickness = use.value;
  if (body.radius) scale.thickness = 2 * *body.radius;
  scale.area = scale.length > 0 ? built.volume() / scale.length : 0;
  scale.density = built.volume() > 0 ? built.mass() / built.volume() : 0;
  if (is_carrier(body)) return scale;
  const bool waits = s.scene.solver.kind == SolverKind::statics;
  for (const MaterialUse& use : body.materials) {
    const Material& m = use.material;
    const bool fades = waits && m.viscosity && !m.viscosity->instantaneous_statics;
    const double E = fades ? lasting_constants(m).young() : m.young();
    scale.long_term = scale.long_term || fades;
    scale.stiffest = std::max(scale.stiffest, E);
    scale.softest = scale.softest > 0 ? std::min(scale.softest, E) : E;
  }
  return scale;
}

Place place_of_material(const Scene& scene, const Material& material, const char* key) {
  const std::string path = material.place.key + "." + key;
  return scene.says(path) ? scene.place_of(path) : material.place;
}

/// Muscle that pushes, that ends at rest, or that presses St Venant-Kirchhoff's law flat where nothing pulls back: to
/// √(1 − 2 σ/E) of its length.
void warn_of_muscle(Simulation& s, const Body& body, std::set<std::string>& told) {
  const bool statics = s.scene.solver.kind == SolverKind::statics, thin = body.radius || !body.thickness.empty();
  for (const MaterialUse& use : body.materials) {
    const Material& m = use.material;
    if (!m.activation || !told.insert(m.place.key + ".active").second) continue;
    const Schedule& schedule = m.activation->schedule;
    const auto* table = std::get_if<TableProfile>(&schedule.profile);
    const bool falls = table != nullptr && std::any_of(table->points.begin(), table->points.end(),
                                                       [](const auto& row) { return row[1] < 0; });
    if (falls || std::holds_alternative<SineProfile>(schedule.profile))
      s.warnings.add("load", m.activation->place, "has a factor that falls below 0: the muscle pushes; muscle pulls");
    if (statics && table != nullptr && table->points.back()[1] == 0)
      s.warnings.add("load", m.activation->place,
                     "ends with a factor of 0, where a static solve ends: the muscle does nothing there; end the "
                     "table where it pulls, or use a dynamic solver");
    const bool fades = statics && m.viscosity && !m.viscosity->instantaneous_statics;
    const double E = fades ? lasting_constants(m).young() : m.young();
    const double part = m.activation->stress * largest_factor(schedule) / E;
    constexpr double kHalf = 0.5 - 1e-9;  // as Lamé's parameters round it
    if (part >= kHalf && m.law == Law::st_venant_kirchhoff && body.formulation == Formulation::large_strain)
      s.warnings.add("load", m.activation->place,
                     fmt::format("reaches {:.2g} of Young's modulus: St Venant-Kirchhoff muscle is pressed flat from "
                                 "0.5 on where nothing pulls back{}",
                                 part, thin ? "" : "; take law = \"neo-hookean\""));
  }
}

void warn_of_bodies(Simulation& s) {
  std::set<std::string> told;  // materials, once each
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const Body& body = s.scene.bodies[b];
    if (body.model == BodyModel::surface) continue;
    const BodyScale scale = scale_of(s, b);
    const bool right_density = warn_of_density(s, body, scale);
    warn_of_distance(s, body, scale, s.bodies[b].nodes);
    warn_of_inertia(s, body, *s.bodies[b].body);
    warn_of_muscle(s, body, told);
    if (is_carrier(body) || body.materials.empty()) continue;
    warn_of_single_cell(s, body, scale);
    warn_of_thickness(s, body, scale);
    if (!warn_of_scale(s, body, scale)) continue;
    if (right_density) warn_of_stiffness(s, body, scale, told);
    if (right_density && warn_of_size(s, body, scale, s.bodies[b].body->mass())) warn_of_sag(s, body, scale);
  }
}

std::vector<NamedSchedule> schedules_of(const Scene& scene) {
  std::vector<NamedSchedule> all{{"world", &scene.world.schedule}};
  for (std::size_t i = 0; i < scene.constraints.size(); ++i)
    all.push_back({fmt::format("constraints[{}]", i), &scene.constraints[i].schedule});
  for (std::size_t i = 0; i < scene.loads.size(); ++i)
    all.push_back({fmt::format("loads[{}]", i), &scene.loads[i].schedule});
  for (const Body& b : scene.bodies)
    if (b.fluid) all.push_back({"bodies." + b.name + ".fluid", &b.fluid->schedule});
  std::set<std::string> seen;
  for (const Body& b : scene.bodies)
    for (const MaterialUse& use : b.materials)
      if (const auto& active = use.material.activation; active && seen.insert(active->place.key).second)
        all.push_back({active->place.key, &active->schedule});
  return all;
}

bool grows_over(const Schedule& schedule) {
  return std::holds_alternative<LinearProfile>(schedule.profile) ||
         std::holds_alternative<SmoothProfile>(schedule.profile);
}

double largest_factor(const Schedule& schedule) {
  const auto* table = std::get_if<TableProfile>(&schedule.profile);
  if (table == nullptr) return 1;
  double largest = 0;
  for (const auto& [time, factor] : table->points) largest = std::max(largest, std::abs(factor));
  return largest;
}

void warn_of_the_implausible(Simulation& s) {
  warn_of_bodies(s);
  warn_of_loads(s);
  warn_of_couplings(s);
  warn_of_times(s);
  warn_of_no_effect(s);
  warn_of_overlaps(s);
}

}  // namespace fascia::app
