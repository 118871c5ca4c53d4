#include "app/estimate/plan.hpp"

#include "assembly/specification/errors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

/// Up to here a finer twin is a matter of a minute on one core: unknowns of one solve, times the steps of dynamics.
constexpr double kMostUnknowns = 60'000;
constexpr double kMostImplicitWork = 3e6, kMostExplicitWork = 3e8;

const char* name_of(TwinRole role) {
  switch (role) {
    case TwinRole::finer:
      return "the finer twin";
    case TwinRole::coarser:
      return "the coarser twin";
    case TwinRole::coarsest:
      return "the coarsest twin";
    case TwinRole::shorter_step:
      return "the twin of half the time step";
    case TwinRole::exact:
      return "the twin of tight tolerances";
    default:
      return "the twin in double precision";
  }
}

/// Unknowns of the twin over those of the scene.
double more_unknowns(const Simulation& s, const SceneTwin& twin) {
  double before = 0, after = 0;
  for (const SimulatedBody& b : s.bodies) {
    const double unknowns = b.body->node_count() * (b.vertices ? 3.0 : 6.0);
    const auto growth = twin.nodes.find(b.name);
    before += unknowns;
    after += unknowns * (growth == twin.nodes.end() ? 1 : growth->second);
  }
  return before > 0 ? after / before : 1;
}

/// Time of a solve of `more` times the unknowns, by factorisation of a solid's stiffness or, explicit, by steps.
double more_time(const Simulation& s, double more) {
  constexpr double factorisation = 1.5;
  return s.scene.solver.kind == SolverKind::central_differences ? more : std::pow(more, factorisation);
}

class Planner {
 public:
  explicit Planner(const Simulation& s) : s_(s), scene_(s.scene) {}

  EstimatePlan plan() {
    plan_discretisation();
    plan_time();
    plan_solver();
    if (SceneTwin twin = in_double(scene_); twin.complete()) add(TwinRole::in_double, std::move(twin), 1);
    return std::move(plan_);
  }

 private:
  void note(std::string sentence) { plan_.notes.push_back(std::move(sentence)); }
  void add(TwinRole role, SceneTwin twin, double cost) {
    if (scene_.solver.budget && role != TwinRole::exact) twin.overrides.emplace_back("solver.budget=\"none\"");
    plan_.twins.push_back({role, name_of(role), std::move(twin), cost});
  }
  bool explicit_steps() const { return scene_.solver.kind == SolverKind::central_differences; }
  /// The step that an automatic one begins with.
  std::optional<double> automatic_step() const {
    return scene_.solver.time_step_automatic ? std::optional(scene_.solver.time_step) : std::nullopt;
  }

  /// How the time step of explicit steps shrinks with halved cells. Half of an automatic step, which is as long as is
  /// stable, may be a little too long there.
  double step_of_halved_cells() const { return automatic_step() ? 0.4 : 0.5; }

  /// A twin of another mesh. Explicit steps keep their length, or shrink with the cells, which keeps them stable.
  SceneTwin other_mesh(SceneTwin mesh, double step) const {
    if (!explicit_steps() || (step == 1 && !automatic_step())) return mesh;
    return mesh + with_time_step(scene_, step, automatic_step());
  }

  bool small_enough(double unknowns) const {
    if (!is_dynamic(scene_.solver.kind)) return unknowns <= kMostUnknowns;
    return unknowns * scene_.solver.steps <= (explicit_steps() ? kMostExplicitWork : kMostImplicitWork);
  }

  void add_coarser(const SceneTwin& mesh, TwinRole role) {
    const double less = more_unknowns(s_, mesh);
    add(role, other_mesh(mesh, 1), more_time(s_, less));
  }

  void plan_discretisation() {
    const SceneTwin finer = refined(scene_, 2), coarser = coarsened(scene_, 2), coarsest = coarsened(scene_, 4);
    const EstimateBy by = *scene_.output.estimate;
    const double more = more_unknowns(s_, finer), unknowns = more * s_.model.free_dof_count();
    const bool small = small_enough(unknowns);
    if (finer.complete() && by != EstimateBy::coarser && (small || by == EstimateBy::finer)) {
      note(fmt::format("discretisation: by a finer twin: {}", fmt::join(finer.changes, "; ")));
      add(TwinRole::finer, other_mesh(finer, step_of_halved_cells()),
          more_time(s_, more) / (explicit_steps() ? step_of_halved_cells() : 1));
      if (coarser.complete()) add_coarser(coarser, TwinRole::coarser);
    } else if (coarser.complete() && by != EstimateBy::finer) {
      note(fmt::format(
          "discretisation: by coarser twins{}: {}",
          small || !finer.complete() ? "" : fmt::format(", as a finer one would have {:.3g} unknowns", unknowns),
          fmt::join(coarser.changes, "; ")));
      add_coarser(coarser, TwinRole::coarser);
      if (coarsest.complete()) add_coarser(coarsest, TwinRole::coarsest);
    } else if (!finer.complete()) {
      const bool nothing = finer.kept.empty();
      note(fmt::format("discretisation: no estimate, because {}",
                       nothing ? "no body has a field of its own" : fmt::format("{}", fmt::join(finer.kept, "; "))));
    } else {
      note(fmt::format(
          "discretisation: no estimate, because {}, and a finer twin would have {:.3g} unknowns and take "
          "about {:.3g} times as long; output.estimate = \"finer\" runs it",
          coarser.complete() ? "coarser twins were not asked for" : fmt::format("{}", fmt::join(coarser.kept, "; ")),
          unknowns, more_time(s_, more)));
    }
  }

  void plan_time() {
    if (!is_dynamic(scene_.solver.kind)) return;
    const SceneTwin shorter = with_time_step(scene_, 0.5, automatic_step());
    note(fmt::format("time: by a twin of half the step: {}", fmt::join(shorter.changes, "; ")));
    add(TwinRole::shorter_step, shorter, 2);
  }

  void plan_solver() {
    const SceneTwin exact = solved_exactly(scene_);
    if (!exact.complete()) return;
    note(fmt::format("solver: by a twin of tight tolerances: {}", fmt::join(exact.changes, "; ")));
    add(TwinRole::exact, exact, 1.3);
  }

  const Simulation& s_;
  const Scene& scene_;
  EstimatePlan plan_;
};

}  // namespace

double EstimatePlan::cost() const {
  double sum = 0;
  for (const PlannedTwin& twin : twins) sum += twin.cost;
  return sum;
}

EstimatePlan plan_estimate(const Simulation& s) {
  const auto is_frequency = [](const Probe& p) { return p.quantity == Quantity::frequency; };
  const std::vector<Probe>& probes = s.scene.probes;
  if (s.scene.solver.kind == SolverKind::modes && std::none_of(probes.begin(), probes.end(), is_frequency))
    throw SceneError({{s.scene.place_of("output.estimate"),
                       "there is nothing to estimate; give the scene a probe of quantity \"frequency\""}});
  for (const Probe& p : probes)
    if (p.name == "bodies")
      throw SceneError({{p.place,
                         "\"bodies\" is where the estimated errors of bodies stand; give the probe another "
                         "name, or remove output.estimate"}});
  return Planner(s).plan();
}

}  // namespace fascia::app
