#include "app/estimate/estimate.hpp"

#include "app/estimate/measure.hpp"
#include "app/estimate/twin_runs.hpp"
#include "app/reader/parse.hpp"
#include "app/results/probes.hpp"
#include "app/run/load_scene.hpp"
#include "assembly/specification/readable.hpp"
#include "core/base/clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kRounding = 1e-12;
constexpr const char *kByFiner = "finer", *kByCoarser = "coarser";  ///< as of output.estimate, and for lines.cpp

bool is_solid(const Body& body) {
  return is_mesh_model(body) || (body.model == BodyModel::meshless && body.thickness.empty() && !body.radius);
}

/// Orders that theory allows a quantity of a body, or of the scene: linear elements and frames converge as h² and no
/// faster, quadratic ones up to h⁴ where nothing is singular; strains and stresses, which are derivatives, later. At
/// the edges and corners of what holds a solid the strain is singular: there the order is near 1.6, and as little as 1.
OrderGuard guard_of(const Scene& scene, const std::optional<std::string>& body, bool derivative) {
  constexpr double singular = 1.6;
  bool quadratic = false, solid = false;
  for (const Body& b : scene.bodies) {
    if ((body && b.name != *body) || is_carrier(b)) continue;
    quadratic = quadratic || b.order == 2;
    solid = solid || is_solid(b);
  }
  return {derivative && !quadratic ? 1 : solid ? singular : 2, 1, quadratic ? 4.0 : 2.0};
}

/// Differences of a quantity that rounding makes.
double rounding_of(const Simulation& s, Quantity quantity) {
  double size = 0;
  for (const SimulatedBody& b : s.bodies) size = std::max(size, b.body->size());
  switch (quantity) {
    case Quantity::displacement:
    case Quantity::position:
    case Quantity::max_displacement:
    case Quantity::mean_displacement:
      return kRounding * size;
    case Quantity::rotation:
    case Quantity::strain:
      return kRounding;
    default:
      return 0;
  }
}

Json json_of(const std::optional<double>& error) { return error ? Json(*error) : Json(nullptr); }

/// @param of_components  the quantity's own are of interest
Json json_of(const EstimatedError& e, const std::string& unit, bool of_components) {
  Json j{{"discretisation", json_of(e.discretisation)},
         {"time", json_of(e.time)},
         {"solver", json_of(e.solver)},
         {"precision", json_of(e.precision)},
         {"total", json_of(e.total())},
         {"scale", e.scale},
         {"unit", unit}};
  if (!e.components.empty() && of_components) j["components"] = e.components;
  if (e.order > 0) j["order"] = e.order;
  if (e.order > 0) j["order_measured"] = e.order_measured;
  if (e.order > 0) j["method"] = e.by_finer ? kByFiner : kByCoarser;
  return j;
}

/// The mesh of the coarsest twin, at whose nodes displacements are compared; null where it is no scene.
std::unique_ptr<Simulation> coarsest_mesh(const Simulation& s, const EstimatePlan& plan) {
  const PlannedTwin* coarsest = nullptr;
  for (const PlannedTwin& twin : plan.twins)
    if (twin.role == TwinRole::coarsest || (twin.role == TwinRole::coarser && !coarsest)) coarsest = &twin;
  if (!coarsest) return nullptr;
  std::vector<std::string> overrides = s.scene.overrides;
  overrides.insert(overrides.end(), coarsest->twin.overrides.begin(), coarsest->twin.overrides.end());
  try {
    return std::make_unique<Simulation>(build_within_memory(parse_scene_text(s.scene.text, s.scene.path, overrides)));
  } catch (const std::exception&) {  // the twin's own run says why
    return nullptr;
  }
}

bool has_tolerance(SolverKind kind) { return kind != SolverKind::central_differences && kind != SolverKind::modes; }

/// The residual of the last iterations where they solved with a factorisation and left next to nothing: an error of as
/// small a part, which no other tolerance would show.
std::optional<double> small_residual(const Json& summary) {
  constexpr double next_to_nothing = 1e-9;
  const auto residual = summary.at("residual").get<double>();
  const bool direct = summary.at("linear_iterations").get<int>() == 0 && summary.at("newton_iterations").get<int>() > 0;
  return direct && residual <= next_to_nothing ? std::optional(residual) : std::nullopt;
}

void drop_exact_twin(EstimatePlan& plan, double residual) {
  std::erase_if(plan.twins, [](const PlannedTwin& twin) { return twin.role == TwinRole::exact; });
  for (std::string& note : plan.notes)
    if (note.starts_with("solver: "))
      note = fmt::format("solver: the residual of the steps, {:.1g}, as the stiffness was factorised", residual);
}

}  // namespace

Estimate::Estimate(const Simulation& simulation) : simulation_(simulation), plan_(plan_estimate(simulation)) {
  if (simulation.scene.solver.kind == SolverKind::modes) return;
  fields_ = std::make_unique<FieldSamples>(simulation, coarsest_mesh(simulation, plan_).get());
}

bool Estimate::run(const std::filesystem::path& directory, Json& summary,
                   const std::function<void(const std::string&)>& tell, const std::function<bool()>& stop) {
  const Clock::time_point start = Clock::now();
  const std::optional<double> residual = small_residual(summary);
  if (residual) drop_exact_twin(plan_, *residual);
  const SolverKind kind = simulation_.scene.solver.kind;
  const Json& seconds = summary.at("seconds");
  tell(fmt::format("estimate: {} more runs, about {}", plan_.twins.size(),
                   time_text(plan_.cost() * (seconds.at("setup").get<double>() + seconds.at("solve").get<double>()))));
  const ProbeTable own(directory);
  const TwinRuns twins(simulation_, plan_, fields_.get(), directory, tell, stop);
  if (twins.stopped()) return false;
  const bool precision = simulation_.scene.solver.precision != "double";
  const bool halved = kind == SolverKind::central_differences;
  const bool cut = summary.contains("budget") && summary["budget"]["cut_steps"].get<int>() > 0;
  const auto told = [&](EstimatedError error, const std::string& unit, bool of_components, bool solved_for = true) {
    if (residual && has_tolerance(kind)) error.solver = solved_for ? residual : 0.0;
    return json_of(error, unit, of_components);
  };
  Json errors = Json::object();
  for (const Probe& p : simulation_.scene.probes) {
    const auto of_twin = [&](TwinRole role) { return twins.probe(role, p.name); };
    const SeriesNorm norm = p.quantity == Quantity::frequency ? SeriesNorm::largest_relative : SeriesNorm::euclidean;
    errors[p.name] = told(measured({own.series(p.name, kind), of_twin, norm, rounding_of(simulation_, p.quantity),
                                    guard_of(simulation_.scene, p.body, is_derivative(p.quantity)), halved, cut},
                                   kind, precision),
                          probe_unit(p.quantity), true, p.quantity != Quantity::mass);
  }
  for (std::size_t b = 0; fields_ && b < fields_->size(); ++b) {
    const auto of_twin = [&](TwinRole role) { return twins.field(role, b); };
    errors["bodies"][fields_->body(b)] =
        told(measured({fields_->series(b, is_dynamic(kind)), of_twin, SeriesNorm::euclidean,
                       rounding_of(simulation_, Quantity::displacement),
                       guard_of(simulation_.scene, fields_->body(b), false), halved, cut},
                      kind, precision),
             "m", false);
  }
  std::vector<std::string> notes = plan_.notes;
  notes.insert(notes.end(), twins.failures().begin(), twins.failures().end());
  const Json provenance = summary.at("provenance");
  summary.erase("provenance");
  summary["estimated_error"] = std::move(errors);
  summary["estimate"] = {{"how", notes}, {"runs", twins.runs()}, {"seconds", seconds_since(start)}};
  summary["provenance"] = provenance;
  return true;
}

std::vector<std::string> plan_lines(const EstimatePlan& plan) {
  std::vector<std::string> lines{
      fmt::format("estimate: {} more runs, about {:.2g} times the time of the run", plan.twins.size(), plan.cost())};
  for (const std::string& note : plan.notes) lines.push_back("estimate: " + note);
  return lines;
}

}  // namespace fascia::app
