#include "core/run/drivers_body.hpp"

namespace fascia {

std::string convergence_sentence(const NewtonReport& r, const SolverSettings& settings) {
  std::ostringstream out;
  out.precision(2);
  switch (r.convergence) {
    case Convergence::none:
      return "";
    case Convergence::tolerance:
      out << "residual " << r.last.relative << " of what acts, within the tolerance " << settings.tolerance;
      if (r.last.left_of_load > 100 * settings.tolerance)
        out << " (" << r.last.left_of_load << " of the loads on a part that is soft or light beside the others)";
      break;
    case Convergence::rounding:
      out << "residual " << r.last.relative << " of what acts, which is what rounding leaves (" << r.last.relative_floor
          << ")";
      if (r.last.left_of_load > kLargestShare) out << " and moves nothing: the last correction gained no strain energy";
      break;
    case Convergence::stagnation:
      out << "residual " << r.last.left_of_load
          << " of the loads, which falls no further, and the last correction was small";
      break;
  }
  return out.str();
}

std::string passed_sentence(double from, double to) {
  std::ostringstream out;
  out << "between load factors " << from << " and " << to
      << " the tangent stiffness became indefinite: the structure may have passed a limit point or a bifurcation, and "
         "what follows may be another equilibrium than the path leads to; compare with more load_steps, or follow the "
         "path with control = \"arc-length\"";
  return out.str();
}

std::string detour_sentence(double to) {
  std::ostringstream out;
  out << "on the way to load factor " << to
      << " Newton's method met tangents that were not positive definite: where several equilibria exist, it may have "
         "found another one than the path leads to";
  return out.str();
}

std::string too_short_sentence(const StepBudget& budget) {
  std::ostringstream out;
  out.precision(2);
  out << "the budget of a step, " << budget.seconds() << " s, holds no iteration of Newton's method, which took "
      << budget.least() << " s at least; give solver.budget more, or fewer frames or cells (need.step chooses them)";
  return out.str();
}

namespace {

/// Rounding leaves about as much, and no step is short enough to change that.
bool is_left_by_rounding(const Evaluation& last, const SolverSettings& settings) {
  constexpr double kAbout = 10;
  return last.relative > settings.tolerance && last.relative <= kAbout * last.relative_floor;
}

/// The residual that was left, against what it should be.
void describe_residual(const Evaluation& last, const SolverSettings& settings, std::ostream& out) {
  if (last.relative > settings.tolerance) {
    out << ", residual " << last.relative << " > " << settings.tolerance;
    // Relative to what acts in all of a whole, or to rounding where that is more.
    if (last.left_of_load > 2 * last.relative) out << " (" << last.left_of_load << " of the loads on a part)";
  } else {
    out << ", residual " << last.left_of_load << " > " << kLargestShare
        << " of the loads on a part that is soft or light beside the others";
  }
  if (is_left_by_rounding(last, settings))
    out << ", where rounding leaves up to " << last.relative_floor
        << ": the body is too thin for its elements or frames, or its parts too unlike (check tells the digits left); "
           "a shell, a sheet or a line may do";
}

}  // namespace

std::string failure_sentence(const NewtonReport& r, const SolverSettings& settings) {
  std::ostringstream out;
  switch (r.status) {
    case NewtonStatus::converged:
    case NewtonStatus::stopped:
    case NewtonStatus::astray:
      return "";
    case NewtonStatus::out_of_time:
      out << "the step's budget ended after " << r.iterations << " iterations of Newton's method";
      describe_residual(r.last, settings, out);
      break;
    case NewtonStatus::limit:
      out << "Newton stopped after " << r.iterations << " iterations";
      describe_residual(r.last, settings, out);
      break;
    case NewtonStatus::stalled:
      if (r.last.excess > 1) {
        out << "Newton found no better state along its direction";
        describe_residual(r.last, settings, out);
      } else {
        out << "the prescribed motion could not be carried out: elements or points would turn inside out";
      }
      break;
    case NewtonStatus::unsolved:
      out << "conjugate gradients end at their " << settings.cg.max_iterations
          << " iterations, and Newton's method gets no further with what they give";
      describe_residual(r.last, settings, out);
      out << "; use linear = { kind = \"cholesky\" }, or more linear.max_iterations";
      break;
    case NewtonStatus::not_finite:
      out << "the forces are not finite";
      break;
    case NewtonStatus::linear_failure:
      out << "the linear system could not be solved";
      break;
  }
  if (!r.trouble.empty()) out << "; " << r.trouble;
  return out.str();
}

template RunReport run_statics(MechanicalSystem&, State&, const FactorFunction&, const SolverSettings&,
                               const StaticsSettings&, const StepObserver&);
template RunReport run_implicit(MechanicalSystem&, State&, const FactorFunction&, const SolverSettings&,
                                const DynamicsSettings&, const StepObserver&);

}  // namespace fascia
