#include "fascia/run/result_warnings.hpp"

#include "assembly/simulation/matter.hpp"
#include "assembly/simulation/places.hpp"

#include "core/base/index.hpp"
#include "fascia/run/edge_bulges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fascia {

namespace {

/// A triangle with less of its area collapses: strains of that size are no physical state of this law.
constexpr double kCollapsed = 0.1;

/// Tension folds a shell's triangles from about this on: the largest strain times the square of the middle one of the
/// sides over the thickness, the longer side of a cell that was halved (docs/manual/shells.md, "Thin shells that are
/// pulled").
constexpr double kFolds = 2.5;

/// The largest stretch of a triangle's plane, squared. @param X, x  corners at rest and now
double largest_stretch_squared(const Vec3d (&X)[3], const Vec3d (&x)[3]) {
  const Vec3d A = X[1] - X[0], B = X[2] - X[0], a = x[1] - x[0], b = x[2] - x[0];
  const double AA = dot(A, A), AB = dot(A, B), BB = dot(B, B), area = AA * BB - AB * AB;
  const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b);
  const double half_trace = (BB * aa - 2 * AB * ab + AA * bb) / (2 * area);
  const double determinant = (aa * bb - ab * ab) / area;
  return half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - determinant));
}

/// Where the tension is so large for the triangles' size that they may fold by themselves.
struct Folds {
  int triangles = 0;
  double largest = 0, strain = 0, slenderness = 0;  ///< the largest of strain · slenderness², and of what it is
  Vec3d where;

  void look(const Vec3d (&X)[3], const Vec3d (&x)[3], double volume) {
    const double area = 0.5 * norm(cross(X[1] - X[0], X[2] - X[0])), thickness = volume / area;
    std::array<double, 3> side{norm(X[1] - X[0]), norm(X[2] - X[1]), norm(X[0] - X[2])};
    std::sort(side.begin(), side.end());
    const double tension = 0.5 * (largest_stretch_squared(X, x) - 1), l = side[1] / thickness, size = tension * l * l;
    triangles += size > kFolds ? 1 : 0;
    if (size <= largest) return;
    largest = size, strain = tension, slenderness = l;
    where = (1.0 / 3) * (X[0] + X[1] + X[2]);
  }
};

/// Statics judge stability by their tangent, and dynamics do not: where that became indefinite on the way and the
/// tension is so large, folds are likely.
void warn_of_folds(const SimulatedBody& b, const Folds& folds, RunReport& run, Warnings& warnings) {
  if (folds.triangles == 0) return;
  run.doubts.push_back(fmt::format(
      "body \"{}\": {} of {} triangles are too large for the tension in them, worst at ({:.4g}, {:.4g}, {:.4g}), where "
      "the strain is {:.2g} and the second longest side {:.3g} thicknesses: strain times the square of that is {:.3g}, "
      "and from {:g} on triangles may fold by themselves, which is the mesh's doing; take sides below {:.2g} "
      "thicknesses "
      "there, or a meshless sheet",
      b.name, folds.triangles, b.body->points().size(), folds.where[0], folds.where[1], folds.where[2], folds.strain,
      folds.slenderness, folds.largest, kFolds, std::sqrt(kFolds / folds.strain)));
  warnings.add("resolution", run.doubts.back());
}

/// @param inside_out  takes why the state is no physical one
void add_shell_warnings(const SimulatedBody& b, const State& end, bool judged, RunReport& run, Warnings& warnings,
                        std::vector<std::string>& inside_out) {
  int unresolved = 0, against = 0;
  double smallest = 1;
  Vec3d where;
  Folds folds;
  const std::vector<BodyPoint>& triangles = b.body->points();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Attachment a = b.body->attach_point(t);
    const FieldValue f = field_at(a, end);
    unresolved += determinant(Mat3d::identity() + f.D) < kResolved ? 1 : 0;
    against += determinant(Mat3d::identity() + f.H) <= 0 ? 1 : 0;
    Vec3d X[3], x[3];
    for (std::size_t k = 0; k < 3; ++k) {
      X[k] = b.nodes[b.index_of(a.nodes[k])];
      x[k] = X[k] + end.u[static_cast<std::size_t>(a.nodes[k])];
    }
    folds.look(X, x, triangles[t].volume);
    const double left = norm(cross(x[1] - x[0], x[2] - x[0])) / norm(cross(X[1] - X[0], X[2] - X[0]));
    if (left >= smallest) continue;
    smallest = left;
    where = triangles[t].X;
  }
  if (!judged && run.indefinite_steps > 0) warn_of_folds(b, folds, run, warnings);
  if (smallest < kCollapsed)
    warnings.add(
        "inverted",
        fmt::format(
            "body \"{}\": the triangle at ({:.4g}, {:.4g}, {:.4g}) has {:.2g} % of its area left: it collapses, "
            "which St Venant-Kirchhoff materials do not resist; mesh again there if it is a needle or cap",
            b.name, where[0], where[1], where[2], 100 * smallest));
  if (against > 0)
    inside_out.push_back(
        fmt::format("body \"{}\": {} of {} triangles face against the directors of their nodes: no physical state; "
                    "mesh finer there, "
                    "without needles and caps",
                    b.name, against, triangles.size()));
  if (unresolved > 0)
    warnings.add(
        "resolution",
        fmt::format("body \"{}\": the corners of {} of {} triangles are turned against each other by more than a right "
                    "angle: the mesh does not resolve so sharp a bend; use more cells",
                    b.name, unresolved, triangles.size()));
}

/// Why matter of a body may be turned inside out or pressed flat, and what helps.
std::string why_folded(const Body& body) {
  if (body.formulation == Formulation::corotational)
    return "co-rotational elements do not resist that; the result is no physical state (a material of large strain "
           "with law = \"neo-hookean\" would resist)";
  const auto resists = [](const MaterialUse& use) { return use.material.law != Law::st_venant_kirchhoff; };
  if (std::all_of(body.materials.begin(), body.materials.end(), resists))
    return "a step passed through what its law does not bear; the result is no physical state (take smaller steps)";
  const bool thin = body.radius || !body.thickness.empty();
  return std::string("St Venant-Kirchhoff materials do not resist that; the result is no physical state") +
         (thin ? "" : " (law = \"neo-hookean\" would resist)");
}

}  // namespace

SnapWatch::SnapWatch(const Simulation& s) : simulation_(s), factors_(s.factors(0)) {
  for (const SimulatedBody& b : s.bodies)
    for (const BodyPoint& p : b.body->points()) scale_ += p.mu * p.volume;
}

void SnapWatch::look(double time, double energy) {
  if (simulation_.model.points.memory.acts()) return;  // muscle may take back what a load has stretched
  const std::vector<double> factors = simulation_.factors(time);
  bool grew = true;
  for (std::size_t i = 0; i < factors.size(); ++i) grew = grew && std::abs(factors[i]) >= std::abs(factors_[i]);
  // Energies of rounding are no energies: strains of 1e-8.
  if (grew && energy < 0.5 * energy_ && energy_ > 1e-16 * scale_ && warning_.empty())
    warning_ = fmt::format(
        "the elastic energy fell from {:.3g} J to {:.3g} J on the way to load factor {:.4g}, though nothing was "
        "unloaded: the body snapped to another equilibrium, perhaps one that lost a turn; compare with more frames",
        energy_, energy, time);
  energy_ = energy;
  factors_ = factors;
}

namespace {

/// Whether verdicts on the end state are this run's: of statics under load control that converged.
bool is_judged(const Simulation& s, const RunReport& run) {
  const Solver& solver = s.scene.solver;
  return solver.kind == SolverKind::statics && solver.control == StaticControl::load &&
         run.status == RunStatus::converged;
}

/// The body whose node moves most in the softest direction, and where that is.
std::string softest_place(const Simulation& s, const State& end, int node) {
  const int body = body_of_node(s, node);
  if (body < 0) return "";
  const Vec3d x = s.model.rest_position[at(node)] + end.u[at(node)];
  return fmt::format(" (body \"{}\" moves most, near ({:.4g}, {:.4g}, {:.4g}))", s.bodies[at(body)].name, x[0], x[1],
                     x[2]);
}

/// A clause that says so where the law of that body gives way.
std::string softest_yields(const Simulation& s, const State& end, int node) {
  const int body = body_of_node(s, node);
  const std::string cause = body < 0 ? "" : yielding_sentence(s, at(body), end);
  return cause.empty() ? "" : "; " + cause;
}

void judge_stability(const Simulation& s, const State& end, RunReport& run, Warnings& warnings) {
  const Stability& found = run.stability;
  const std::string where = softest_place(s, end, found.node);
  if (!found.known)
    return warnings.add("stability",
                        "the linear solver could not tell whether the end state is stable; linear.kind = "
                        "\"cholesky\" can, where memory allows it");
  if (found.near_limit)
    return warnings.add("stability",
                        "the end state is near a limit point or a bifurcation" + where +
                            ": less than a hundredth of the lowest stiffness is left; a slightly larger load may have "
                            "no equilibrium nearby");
  if (!found.is_unstable()) return;
  if (!s.model.loads_are_conservative())
    return warnings.add(
        "stability",
        "the end state may be an unstable equilibrium" + where +
            ": its tangent has a real negative eigenvalue; loads that follow the body have no energy, and dynamics "
            "alone shows what becomes of it");
  const std::string message =
      "the end state is an unstable equilibrium" + where + ": the smallest disturbance makes the body leave it";
  if (s.scene.solver.accept_unstable) return warnings.add("stability", message);
  run.status = RunStatus::unstable;
  run.message =
      message + softest_yields(s, end, found.node) +
      "; try solver.imperfection = 1e-4, control = \"arc-length\", or solver.accept = [\"unstable\"] to keep it";
}

}  // namespace

void add_result_warnings(const Simulation& s, const State& end, RunReport& run, Warnings& warnings) {
  if (run.status == RunStatus::converged && !run.trouble.empty())
    warnings.add("stability", "the end state may be an unstable equilibrium: " + run.trouble);
  const bool judged = is_judged(s, run);
  if (judged) judge_stability(s, end, run, warnings);
  const auto doubt = [&](const char* name, const std::string& text) {
    run.doubts.push_back(text);
    warnings.add(name, text);
  };
  const bool followed = s.scene.solver.control != StaticControl::load;  // then what was passed is known
  for (const std::string& event : run.events)
    if (followed)
      warnings.add("solver", event);
    else
      doubt("solver", event);
  if (run.indefinite_steps > 0)
    doubt(
        "time-step",
        fmt::format("in {} time step{}, first at t = {:.4g} s, the stiffness became indefinite on the way: so "
                    "long a step may have several solutions, of which one was found; compare with a smaller time_step",
                    run.indefinite_steps, run.indefinite_steps == 1 ? "" : "s", run.first_indefinite));
  if (run.halved_steps > 0)
    doubt("time-step",
          fmt::format("{} time step{}, first at t = {:.4g} s, {} taken in parts, because Newton's method did not "
                      "converge in one, or a led boundary took it over an indefinite stiffness: their error of time is "
                      "another one than that of the rest; compare with a smaller time_step",
                      run.halved_steps, run.halved_steps == 1 ? "" : "s", run.first_halved,
                      run.halved_steps == 1 ? "was" : "were"));
  // A muscle that is free has no load beside which to say it.
  if (run.residual_floor > 1e-3 && !(s.model.loads.empty() && s.model.surfaces.empty()) &&
      !s.model.points.memory.acts())
    warnings.add("rounding",
                 fmt::format("rounding leaves {:.1e} of the loads: they are tiny beside the stiffness and the motion",
                             run.residual_floor));
  std::vector<std::string> inside_out;
  for (const SimulatedBody& b : s.bodies) {
    const auto index = static_cast<std::size_t>(&b - s.bodies.data());
    if (is_shell(s.scene.bodies[index])) {
      add_shell_warnings(b, end, judged, run, warnings, inside_out);
      warn_of_edge_bulges(s, b, end, warnings);
      continue;
    }
    const FoldedPoints folded = folded_points(b, end);
    const int inverted = folded.inverted;
    const bool rigid = !b.vertices && !s.scene.bodies[index].affine;
    const int unresolved = rigid ? folded.unresolved : 0;
    const Formulation formulation = s.scene.bodies[index].formulation;
    const bool linear = formulation == Formulation::linear;
    if (inverted > 0 && linear)
      warnings.add("inverted",
                   fmt::format("body \"{}\": {} of {} integration points are turned inside out: the displacements are "
                               "too large for small-strain elasticity; use formulation = \"corotational\" or leave "
                               "it out",
                               b.name, inverted, b.body->points().size()));
    else if (inverted + folded.flat > 0)
      inside_out.push_back(fmt::format("body \"{}\" is {} at {} of {} integration points: {}", b.name,
                                       inverted > 0 ? "turned inside out" : "pressed flat",
                                       inverted > 0 ? inverted : folded.flat, b.body->points().size(),
                                       why_folded(s.scene.bodies[index])));
    if (unresolved > 0)
      warnings.add(
          "resolution",
          fmt::format("body \"{}\": neighbouring frames are turned against each other by more than a right angle at {} "
                      "of {} integration points: their blend does not resolve that; use more frames",
                      b.name, unresolved, b.body->points().size()));
  }
  if (run.status == RunStatus::unstable && !inside_out.empty()) warnings.add("stability", run.message);
  for (const std::string& message : inside_out)
    if (judged && !s.scene.solver.accept_inverted && run.status != RunStatus::inverted) {
      run.status = RunStatus::inverted;
      run.message = message + "; solver.accept = [\"inverted\"] keeps it all the same";
    } else {
      warnings.add("inverted", message);
    }
  if (run.status != RunStatus::converged || run.steps_at_limit + run.steps_out_of_time == 0) return;
  run.status = RunStatus::not_converged;
  if (run.steps_at_limit > 0)
    run.message =
        fmt::format("{} steps were accepted above the tolerance (newton.on_limit = \"continue\")", run.steps_at_limit);
  if (run.steps_out_of_time > 0)
    run.message +=
        fmt::format("{}{} of {} steps ended where their budget did, with residuals of up to {:.2g} of what acts",
                    run.message.empty() ? "" : "; ", run.steps_out_of_time, run.steps, run.left_by_time);
  if (run.steps_without_progress > 0)
    run.message += fmt::format("; {} of them found no better state than they began with: the motion lags there",
                               run.steps_without_progress);
}

}  // namespace fascia
