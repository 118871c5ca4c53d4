#include "tests/random/invariants.hpp"

#include "tests/support/run_program.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <regex>

namespace fascia::random_scenes {
namespace {

constexpr double kTolerance = 1e-10;  ///< Newton's, in the scenes of add_solver()

double length(const Vector& v) { return std::hypot(v[0], v[1], v[2]); }
Vector vector_of(const std::vector<double>& v) { return {v.at(0), v.at(1), v.at(2)}; }
void add(Vector& sum, const Vector& v, double factor = 1) {
  for (std::size_t i = 0; i < 3; ++i) sum[i] += factor * v[i];
}

const Json& solver(const RandomScene& scene) { return scene.tree["solver"]; }
bool is_static(const RandomScene& scene) { return solver(scene)["kind"] == "static"; }

/// Nothing but the initial motion acts, and nothing is held: momentum stays.
bool is_free(const RandomScene& scene) {
  return !scene.tree.contains("constraints") && !scene.tree.contains("loads") && !scene.tree.contains("world") &&
         !(scene.tree.contains("couplings") && scene.tree["couplings"].contains("tie"));
}

bool is_damped_by_mass(const RandomScene& scene) {
  for (const auto& [name, body] : scene.tree["bodies"].items()) {
    if (!body.contains("material")) continue;
    const Json& material = body["material"].is_array() ? body["material"][0]["use"] : body["material"];
    if (material.contains("damping") && material["damping"].contains("mass")) return true;
  }
  return false;
}

/// Small strains resist a rotation with a moment.
bool has_linear_elements(const RandomScene& scene) {
  const Json& bodies = scene.tree["bodies"];
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const Json& body) { return body.value("formulation", "") == "linear"; });
}

/// A body follows another: by a coupling, by frames that they share, or at the ends of what fills the space between
/// two.
bool has_followers(const RandomScene& scene) {
  if (scene.tree.contains("couplings") && !scene.tree["couplings"].empty()) return true;
  const Json& bodies = scene.tree["bodies"];
  return bodies.contains("tissue") || std::any_of(bodies.begin(), bodies.end(), [](const Json& body) {
           return body.contains("frames") && body["frames"].contains("share");
         });
}

double mass_of(const Outcome& run) {
  double mass = 0;
  for (const auto& [name, body] : run.summary["bodies"].items()) mass += body["mass"].get<double>();
  return mass;
}

/// The force that the residual is a part of: the largest that was measured of a probe, a hundredth of the largest that
/// was of its unit, and what cancels in it.
double scale_of(const RandomScene& scene, const Outcome& run, const Measured& probe) {
  double scale = 1e-2 * run.largest(probe.unit);
  for (const std::vector<double>& row : probe.rows)
    for (const double v : row) scale = std::max(scale, std::abs(v));
  const double momentum = mass_of(run) * run.largest("m/s"), length = scene.scales.length;
  const double section = scene.scales.width * scene.scales.width;
  const double force = std::max({scene.load_size, run.largest("N"), run.largest("Pa") * section});
  if (probe.unit == "N") scale = std::max(scale, force);
  if (probe.unit == "N m") scale = std::max(scale, force * length);
  if (probe.unit == "Pa") scale = std::max(scale, scene.load_size / section);
  if (probe.unit == "J") scale = std::max(scale, scene.load_size * run.largest("m"));
  if (probe.unit == "kg m/s") scale = std::max(scale, momentum);
  if (probe.unit == "kg m2/s") scale = std::max(scale, momentum * (length + run.largest("m")));
  return scale;
}

/// Rounding leaves this of displacements that cancel, and of none: 1e-11 of the largest displacement, 1e-17 of the
/// width.
double rounding_of(const RandomScene& scene, const Outcome& run, const std::string& unit) {
  const Scales& s = scene.scales;
  const double size = run.largest("m") + 1e-6 * s.width, strain = 1e-11 * size / s.width;
  const double step = solver(scene).value("time_step", s.time()), speed = strain * s.width / std::min(step, s.time());
  const double force = s.stiffest * s.width * s.width * strain;
  if (unit == "m") return strain * s.width;
  if (unit == "1" || unit == "rad") return strain;
  if (unit == "Pa") return s.stiffest * strain;
  if (unit == "N") return force;
  if (unit == "N m") return force * s.length;
  if (unit == "J") return force * size;
  if (unit == "m/s") return speed;
  if (unit == "kg m/s") return mass_of(run) * speed;
  if (unit == "kg m2/s") return mass_of(run) * speed * s.length;
  return 0;
}

/// Supports and ties carry the loads: the sum of what is free of residual is the sum over all nodes, of each of which
/// at most the residual, a part of the largest force, is left.
std::optional<std::string> balance_of_forces(const RandomScene& scene, const Outcome& run) {
  if (!scene.tree.contains("constraints") || solver(scene).contains("imperfection")) return std::nullopt;
  Vector sum{};
  double scale = 0;
  const auto take = [&](const Vector& force, double factor = 1) {
    add(sum, force, factor);
    scale += std::abs(factor) * length(force);
  };
  const double factor = solver(scene).value("control", "load") == "load" ? 1 : run.times.back();
  for (const std::optional<Vector>& load : scene.resultants) {
    if (!load) return std::nullopt;
    take(*load, factor);
  }
  if (scene.tree.contains("world")) {
    const Vector gravity = scene.tree["world"]["gravity"].get<Vector>();
    for (const auto& [name, body] : run.summary["bodies"].items()) {
      take(gravity, factor * body["mass"].get<double>());
      const Json& drawn = scene.tree["bodies"][name];
      if (drawn.contains("fluid"))
        take(gravity, factor * drawn["fluid"].value("density", 0.0) * body["fluid"]["volume"].get<double>());
    }
  }
  for (const auto& [name, probe] : run.probes)
    if (probe.quantity == "force") take(vector_of(probe.last()));
  scale += scene.load_size + run.largest("Pa") * scene.scales.width * scene.scales.width;
  if (run.summary["couplings"].contains("tie")) take(run.summary["couplings"]["tie"]["force"].get<Vector>());
  const double allowed = 1e2 * std::max(kTolerance, run.residual()) * scale + rounding_of(scene, run, "N");
  if (length(sum) <= allowed) return "";
  return fmt::format("reactions do not balance loads: {} N are left of {} N, {} allowed", length(sum), scale, allowed);
}

/// A residual that is said to be within the tolerance is within that of the scene.
std::optional<std::string> kept_tolerance(const Outcome& run) {
  static const std::regex within("residual ([0-9.e+-]+) .*within the tolerance ([0-9.e+-]+)");
  const std::string said = run.summary["convergence"];
  std::smatch found;
  if (!std::regex_search(said, found, within)) return std::nullopt;  // what rounding leaves, or no step
  return std::stod(found[1]) <= kTolerance && std::stod(found[2]) <= kTolerance ? "" : said;
}

/// Every step leaves at most the residual, a part of inertia.
std::optional<std::string> constant(const Outcome& run, const std::string& name, double scale) {
  const std::vector<std::vector<double>>& rows = run.probes.at(name).rows;
  const Vector first = vector_of(rows.front());
  scale = std::max(scale, length(first));
  const double allowed = 1e2 * std::max(kTolerance, run.residual()) * scale * static_cast<double>(rows.size());
  double most = 0;
  for (const std::vector<double>& row : rows) {
    Vector change = vector_of(row);
    add(change, first, -1);
    most = std::max(most, length(change));
  }
  if (most <= allowed) return "";
  return fmt::format("{} of a free scene changes by {} of {}, {} allowed", name, most, scale, allowed);
}

/// Implicit Euler takes energy out of motion; rounding and the residual give at most a part of the largest.
std::optional<std::string> falling_energy(const RandomScene& scene, const Outcome& run) {
  if (scene.tree.contains("loads") || scene.tree.contains("world")) return std::nullopt;
  if (scene.tree.contains("constraints"))
    for (const Json& c : scene.tree["constraints"])
      if (c.contains("move")) return std::nullopt;
  for (const auto& [name, body] : scene.tree["bodies"].items())
    if (body.contains("fluid") && (body["fluid"].contains("over") || body["fluid"].contains("profile")))
      return std::nullopt;  // what pumps it works
  const auto fades = [](const Json& material) {
    const auto has = [](const Json& part) {
      const Json use = part.value("use", Json());
      return part.contains("viscosity") || use.contains("viscosity") || part.contains("active");
    };
    return material.is_array() ? std::any_of(material.begin(), material.end(), has) : has(material);
  };
  for (const char* where : {"bodies", "materials"}) {
    const Json table = scene.tree.value(where, Json::object());
    for (const auto& [name, entry] : table.items())
      if (fades(entry) || (entry.contains("material") && fades(entry["material"])))
        return std::nullopt;  // what branches hold is not told, nor the work of muscle
  }
  const std::vector<std::vector<double>>& rows = run.probes.at("total_energy").rows;
  const double most = run.largest("J");
  for (std::size_t k = 1; k < rows.size(); ++k)
    if (rows[k][0] - rows[k - 1][0] > 1e2 * std::max(kTolerance, run.residual()) * most)
      return fmt::format("total energy grows from {} J to {} J in step {}", rows[k - 1][0], rows[k][0], k);
  return "";
}

}  // namespace

std::vector<std::string> faults_of_end(const Outcome& run) {
  if (run.timed_out) return {"it hangs"};
  std::vector<std::string> faults;
  if (run.exit_status != 0 && run.exit_status != 2 && run.exit_status != 3)
    faults.push_back(fmt::format("exit status {}: {}", run.exit_status, run.message));
  if (run.exit_status != 0 && run.message.empty()) faults.push_back("it says nothing of why it failed");
  static const std::regex not_finite("(^|[^a-z])-?(nan|inf)([^a-z]|$)", std::regex::icase);
  if (std::regex_search(run.csv, not_finite)) faults.push_back("a number in probes.csv is not finite");
  static const std::regex quoted("found \"nan\"|keyword: nan");  // of a mesh that is made wrong
  if (std::regex_search(std::regex_replace(run.message, quoted, ""), not_finite))
    faults.push_back("a message says nan: " + run.message);
  if (run.exit_status == 2 && !std::regex_search(run.message, std::regex("scene\\.toml:\\d+|\\.(msh|vtk)")))
    faults.push_back("no file and line in: " + run.message);
  if (run.exit_status != 0) return faults;
  if (!run.summary.is_object() || !run.summary.contains("probes")) return {"exit status 0 without a summary"};
  if (run.status() != "converged") faults.push_back("exit status 0, but " + run.status());
  for (const auto& [name, probe] : run.summary["probes"].items())
    if (probe["value"].dump().find("null") != std::string::npos) faults.push_back("probe " + name + " is null");
  return faults;
}

std::vector<std::string> faults_of_refusal(const RandomScene& scene, const SceneText& text, const Outcome& run) {
  const std::string said =
      fmt::format("{} ({}): exit status {}: {}", scene.wrong, scene.blamed, run.exit_status, run.message);
  if (run.exit_status != 2) return {"not refused: " + said};
  if (scene.section.empty() && run.message.find(scene.blamed) != std::string::npos) return {};
  if (scene.section.empty()) return {"the mesh is not named: " + said};
  const int line = text.lines.at(scene.section);
  for (const std::string& told : test::lines_of(run.message))
    if (told.starts_with(fmt::format("scene.toml:{}:", line)) && told.find(scene.blamed) != std::string::npos)
      return {};
  return {fmt::format("line {} and key are not named: {}", line, said)};
}

std::vector<std::string> faults_of_balance(const RandomScene& scene, const Outcome& run,
                                           std::vector<std::string>& checked) {
  std::vector<std::string> faults;
  const auto note = [&](const char* name, const std::optional<std::string>& fault) {
    if (!fault) return;
    checked.emplace_back(name);
    if (!fault->empty()) faults.push_back(*fault);
  };
  const std::string kind = solver(scene)["kind"];
  if (kind != "modes" && kind != "explicit" && run.exit_status == 0) note("tolerance", kept_tolerance(run));
  if (kind == "modes" || run.exit_status != 0 || run.times.empty()) return faults;
  if (is_static(scene)) {
    note("forces", balance_of_forces(scene, run));
    return faults;
  }
  if (is_free(scene) && !is_damped_by_mass(scene)) {
    const double extent = run.largest("m") + scene.scales.length, mass = mass_of(run);
    double energy = 0;  // where no probe of a velocity sees what moves
    for (const std::vector<double>& row : run.probes.at("kinetic_energy").rows) energy = std::max(energy, row[0]);
    const double speed = std::max(run.largest("m/s"), std::sqrt(2 * energy / mass));
    // Newmark's rule balances the nodes that follow a turning body at the end of a step: their momentum to its order.
    const bool nearly = kind == "newmark" && has_followers(scene);
    if (!nearly) note("momentum", constant(run, "momentum", mass * speed));
    if ((kind == "midpoint" || kind == "explicit") && !has_linear_elements(scene))
      note("angular momentum", constant(run, "angular_momentum", mass * speed * extent));
  }
  if (kind == "implicit-euler") note("energy", falling_energy(scene, run));
  return faults;
}

Comparison compare(const RandomScene& scene, const Outcome& run, const Outcome& twin, const Frame& frame) {
  using Kind = Comparison::Kind;
  if (run.exit_status != 0 && run.exit_status == twin.exit_status) return {Kind::alike_failures, 0, ""};
  if (run.exit_status == 2 || twin.exit_status == 2)
    return {Kind::differ, 0,
            fmt::format("exit status {} and {}: {}{}", run.exit_status, twin.exit_status, run.message, twin.message)};
  if (run.says_several_ends() || twin.says_several_ends()) return {Kind::said, 0, ""};
  if (run.exit_status != twin.exit_status)
    return {Kind::one_failed, 0,
            fmt::format("exit status {} and {}: {}{}", run.exit_status, twin.exit_status, run.message, twin.message)};
  Comparison result;
  const double relative = 1e4 * std::max({kTolerance, run.residual(), twin.residual()});
  const bool statics = is_static(scene);
  for (const auto& [name, probe] : run.probes) {
    const Measured& other = twin.probes.at(name);
    if (!statics && probe.rows.size() != other.rows.size())
      return {Kind::differ, 0, fmt::format("{}: {} rows and {}", name, probe.rows.size(), other.rows.size())};
    if (probe.rows.empty() || other.rows.empty()) continue;
    const double factor = frame.factor(probe.unit), scale = factor * scale_of(scene, run, probe);
    const double allowed = relative * scale + factor * rounding_of(scene, run, probe.unit);
    const std::vector<double> wanted = frame.values(probe.last(), probe.quantity, probe.unit);
    if (wanted.size() != other.last().size()) return {Kind::differ, 0, name + ": another number of values"};
    double most = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) most = std::max(most, std::abs(wanted[i] - other.last()[i]));
    if (most <= result.worst * allowed) continue;
    result.worst = most / allowed;
    result.text =
        fmt::format("{}: {} and {}, off by {:.1e}, allowed {:.1e}", name, wanted, other.last(), most, allowed);
  }
  const bool doubted = run.doubts_its_end() || twin.doubts_its_end();
  if (result.worst > 1) result.kind = doubted ? Kind::said : Kind::differ;
  return result;
}

}  // namespace fascia::random_scenes
