#include "app/tune/cost_model.hpp"

#include "core/base/processors.hpp"
#include "core/levels/blocks_or_levels.hpp"
#include "core/tangent/tangent_solver.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

constexpr double kUsualIterations = 5, kStepIterations = 2;
/// An explicit step whose length is found on the way, over one of a given length: 1.74 to 1.9 of frames, hexahedra and
/// tetrahedra.
constexpr double kFound = 1.75;
/// Where points take longer in an iteration, a factor of few unknowns is kept too [s].
constexpr double kWorthKeeping = 1e-3;
/// Iterations of conjugate gradients of a step so short that there is inertia alone.
constexpr double kLeastIterations = 2;
/// The least part of an iteration that the linear solver can have: timing spreads more.
constexpr double kLeastSolve = 0.1;

int dimension_of(const std::string& kind) { return kind == "shell" ? 2 : 3; }

/// a x + b y = z in the sense of least relative squares, a and b not negative.
std::array<double, 2> nonnegative_fit(const std::vector<std::array<double, 3>>& rows) {
  double xx = 0, xy = 0, yy = 0, x = 0, y = 0;
  for (const auto& [px, py, z] : rows) {
    const double u = px / z, v = py / z;
    xx += u * u, xy += u * v, yy += v * v, x += u, y += v;
  }
  const double determinant = xx * yy - xy * xy;
  double a = 0, b = 0;
  if (determinant > 1e-9 * xx * yy) {
    a = (x * yy - y * xy) / determinant;
    b = (xx * y - xy * x) / determinant;
  }
  if (a >= 0 && b >= 0 && (a > 0 || b > 0)) return {a, b};
  // One of them alone: the better.
  const double only_a = xx > 0 ? x / xx : 0, only_b = yy > 0 ? y / yy : 0;
  const auto left = [&](double c, double d) {
    double sum = 0;
    for (const auto& [px, py, z] : rows) sum += std::pow((c * px + d * py) / z - 1, 2);
    return sum;
  };
  return left(only_a, 0) <= left(0, only_b) ? std::array{only_a, 0.0} : std::array{0.0, only_b};
}

double iteration_of(const CostSample& s) { return s.solve / std::max(1.0, s.newton); }

/// The time of the same run on one thread over that of this one; 1 where there is none.
double faster(const std::vector<CostSample>& samples, const CostSample& many) {
  for (const CostSample& s : samples)
    if (s.kind == many.kind && s.factorised == many.factorised && s.dynamics == many.dynamics && s.threads == 1 &&
        s.unknowns == many.unknowns && s.explicit_steps == 0)
      return std::clamp(iteration_of(s) / iteration_of(many), 0.5, 1.0 * many.threads);
  return 1;
}

/// An iteration of an implicit step over what its parts take; runs with a factor keep it from solve to solve.
void fit_threads_and_steps(const std::vector<CostSample>& samples, const std::string& kind, KindCost& cost) {
  double ratio[2] = {}, count[2] = {};
  for (const CostSample& s : samples) {
    if (s.kind != kind || s.explicit_steps > 0) continue;
    if (s.threads > 1 && !s.dynamics) (s.factorised ? cost.faster_factor : cost.faster_cg) = faster(samples, s);
    if (!s.dynamics || s.threads > 1) continue;
    const LinearMethod method = s.factorised ? LinearMethod::cholesky : LinearMethod::cg;
    const LinearUse use{method, dimension_of(kind), s.courant, false};
    ratio[s.factorised] += iteration_of(s) / (cost.point * s.points + linear_cost(cost, s.unknowns, use).seconds);
    count[s.factorised] += 1;
  }
  if (count[0] > 0) cost.step = std::clamp(ratio[0] / count[0], 0.2, 5.0);
  if (count[1] > 0) cost.kept = std::clamp(ratio[1] / count[1], 0.02, 5.0);
}

std::optional<KindCost> fit(const std::vector<CostSample>& samples, const std::string& kind) {
  std::vector<std::array<double, 3>> cg, setup;
  std::vector<const CostSample*> direct;
  KindCost cost;
  double spread = 0, wave = 0;
  int still = 0, waves = 0;
  for (const CostSample& s : samples) {
    if (s.kind != kind || s.threads > 1) continue;
    if (s.explicit_steps > 0) {
      cost.explicit_point = s.solve / (s.explicit_steps * s.points);
      continue;
    }
    const double n = s.linear / std::max(1.0, s.newton);
    if (!s.factorised) cg.push_back({s.points, s.unknowns * n, iteration_of(s)});
    if (!s.dynamics) setup.push_back({1, s.points, s.setup});
    if (s.factorised && !s.dynamics) direct.push_back(&s);
    if (!s.factorised && s.dynamics) wave += std::max(0.0, n - kLeastIterations) / s.courant, ++waves;
    if (!s.factorised && !s.dynamics) spread += n / std::pow(s.unknowns, 1.0 / dimension_of(kind)), ++still;
  }
  if (still < 2 || direct.size() < 2) return std::nullopt;
  cost.spread = spread / still;
  if (waves > 0) cost.wave = wave / waves;
  const auto [point, product] = nonnegative_fit(cg);
  cost.point = point;
  cost.product = product;
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const CostSample* s : direct) {
    const double solve = std::max(kLeastSolve * iteration_of(*s), iteration_of(*s) - cost.point * s->points);
    const double u = std::log(s->unknowns), v = std::log(solve);
    n += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  const double mean = y / n;
  cost.exponent = std::clamp((n * xy - x * y) / std::max(1e-12, n * xx - x * x), 1.0, 2.3);
  cost.factor = std::exp(mean - cost.exponent * x / n);
  const auto [start, setup_point] = nonnegative_fit(setup);
  cost.start = start;
  cost.setup_point = setup_point;
  fit_threads_and_steps(samples, kind, cost);
  return cost;
}

/// Keys of a kind's costs with what they hold.
std::vector<std::pair<const char*, double KindCost::*>> members() {
  return {{"point", &KindCost::point},
          {"factor", &KindCost::factor},
          {"exponent", &KindCost::exponent},
          {"product", &KindCost::product},
          {"spread", &KindCost::spread},
          {"wave", &KindCost::wave},
          {"explicit_point", &KindCost::explicit_point},
          {"start", &KindCost::start},
          {"setup_point", &KindCost::setup_point},
          {"step", &KindCost::step},
          {"kept", &KindCost::kept},
          {"faster_factor", &KindCost::faster_factor},
          {"faster_cg", &KindCost::faster_cg}};
}

}  // namespace

std::string cost_kind(const Body& body) {
  if (is_shell(body)) return "shell";
  if (body.model == BodyModel::meshless && !std::holds_alternative<GridFrames>(body.frames))
    return body.affine ? "scattered-affine" : "scattered";
  if (body.model == BodyModel::meshless) return body.affine ? "affine" : "frames";
  return std::string(body.model == BodyModel::tetrahedra ? "tetrahedra" : "hexahedra") + (body.order == 2 ? "-2" : "");
}

LinearUse linear_use(const Solver& solver, int dimension, double courant, bool conservative) {
  const bool named = solver.preconditioner != PreconditionerKind::automatic;
  LinearMethod method = solver.linear;
  if (method == LinearMethod::automatic && named)
    method = solver.preconditioner == PreconditionerKind::cholesky ? LinearMethod::cholesky : LinearMethod::cg;
  const bool open = method == LinearMethod::automatic && solver.linear_max_iterations >= kEnoughForBulk;
  return {method, dimension, courant, open && conservative && is_implicit_dynamics(solver.kind)};
}

/// As TangentSolver chooses, but that the shape of a body is not known: of more than so many unknowns, and after more
/// iterations than blocks may have, the cheaper of the two is taken.
LinearCost linear_cost(const KindCost& cost, double unknowns, const LinearUse& use) {
  static const int patience = BlocksOrLevels({}).patience();
  double n = cost.spread * std::pow(unknowns, 1.0 / use.dimension);
  if (use.courant > 0) n = std::min(n, kLeastIterations + cost.wave * use.courant);
  const LinearCost factor{cost.factor * std::pow(unknowns, cost.exponent), true},
      cg{cost.product * unknowns * n, false};
  if (use.method != LinearMethod::automatic) return use.method == LinearMethod::cholesky ? factor : cg;
  if (use.blocks_first && unknowns > TangentSolver::kDirectDofsWithInertia) {
    if (n <= patience) return cg;
  } else if (unknowns <= TangentSolver::kDirectDofs) {
    return factor;
  }
  return factor.seconds < cg.seconds ? factor : cg;
}

double courant_of(const Simulation& s) {
  const Solver& solver = s.scene.solver;
  double most = 0;
  for (std::size_t b = 0; b < s.bodies.size() && is_implicit_dynamics(solver.kind); ++b) {
    const ModelBody& body = *s.bodies[b].body;
    if (is_carrier(s.scene.bodies[b]) || body.mass() == 0) continue;
    double stiffness = 0;
    for (const MaterialUse& use : s.scene.bodies[b].materials)
      stiffness = std::max(stiffness, use.material.lambda + 2 * use.material.mu);
    const double speed = std::sqrt(stiffness * body.volume() / body.mass());
    most = std::max(most, speed * solver.time_step / mean_spacing(s.bodies[b]));
  }
  return most;
}

nlohmann::ordered_json CostModel::json() const {
  nlohmann::ordered_json j = nlohmann::ordered_json::object();
  for (const auto& [kind, cost] : kinds)
    for (const auto& [key, member] : members()) j[kind][key] = cost.*member;
  return j;
}

std::optional<CostModel> CostModel::read(const nlohmann::ordered_json& json) {
  CostModel model;
  if (!json.is_object()) return std::nullopt;
  for (const auto& [kind, values] : json.items())
    for (const auto& [key, member] : members()) {
      if (!values.is_object() || !values.contains(key) || !values[key].is_number()) return std::nullopt;
      const double value = values[key].get<double>();
      if (!std::isfinite(value) || value < 0) return std::nullopt;
      model.kinds[kind].*member = value;
    }
  return model;
}

CostModel fitted_costs(const std::vector<CostSample>& samples) {
  CostModel model;
  for (const CostSample& s : samples)
    if (!model.kinds.contains(s.kind))
      if (const auto cost = fit(samples, s.kind)) model.kinds[s.kind] = *cost;
  return model;
}

std::optional<TimeForecast> forecast_time(const Simulation& s, const CostModel& costs) {
  const Solver& solver = s.scene.solver;
  if (solver.kind == SolverKind::modes || solver.control != StaticControl::load) return std::nullopt;
  const double unknowns = s.model.free_dof_count();
  const bool many = available_processors() > 1 && solver.threads != 1;
  const bool is_explicit = solver.kind == SolverKind::central_differences;
  double points = 0, kept = 0, setup = 0, most = -1;  // kept: what points cost where a factor is kept
  const KindCost* main = nullptr;
  bool linear = true;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const Body& body = s.scene.bodies[b];
    if (is_carrier(body)) continue;
    const auto cost = costs.kinds.find(cost_kind(body));
    if (cost == costs.kinds.end() || (is_explicit && cost->second.explicit_point == 0)) return std::nullopt;
    const auto count = static_cast<double>(s.bodies[b].body->points().size());
    points += (is_explicit ? cost->second.explicit_point : cost->second.point) * count;
    kept += cost->second.point * cost->second.kept * count;
    setup += cost->second.start * (main ? 0 : 1) + cost->second.setup_point * count;
    linear = linear && body.formulation == Formulation::linear;
    if (s.bodies[b].body->node_count() > most) main = &cost->second, most = s.bodies[b].body->node_count();
  }
  if (!main) return std::nullopt;
  TimeForecast forecast;
  if (is_explicit) {
    forecast.iterations = solver.steps;
    const double step = points * (solver.time_step_automatic ? kFound : 1);
    forecast.seconds = setup + forecast.iterations * step / (many ? main->faster_cg : 1);
    return forecast;
  }
  const bool dynamics = is_dynamic(solver.kind);
  forecast.iterations = dynamics ? solver.steps * (linear ? 1 : kStepIterations)
                                 : std::max(1, solver.load_steps) * (linear ? 1 : kUsualIterations);
  const bool shell = std::all_of(s.scene.bodies.begin(), s.scene.bodies.end(),
                                 [](const Body& b) { return is_carrier(b) || is_shell(b); });
  const LinearUse use = linear_use(solver, shell ? 2 : 3, courant_of(s), s.model.loads_are_conservative());
  const LinearCost solve = linear_cost(*main, unknowns, use);
  const double speed = many ? (solve.factorised ? main->faster_factor : main->faster_cg) : 1;
  double iteration = (points + solve.seconds) * (dynamics ? main->step : 1) / speed;
  if (use.blocks_first && (unknowns > TangentSolver::kDirectDofsWithInertia || points > kWorthKeeping)) {
    const double factor = main->factor * std::pow(unknowns, main->exponent);  // takes the place of slower blocks
    iteration = std::min(iteration, (kept + factor * main->kept) / (many ? main->faster_factor : 1));
  }
  forecast.seconds = setup + forecast.iterations * iteration;
  return forecast;
}

}  // namespace fascia::app
