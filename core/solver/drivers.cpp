#include "core/solver/drivers_body.hpp"

namespace fascia {

std::string failure_sentence(const NewtonReport& r, const SolverSettings& settings) {
  std::ostringstream out;
  switch (r.status) {
    case NewtonStatus::converged:
      return "";
    case NewtonStatus::limit:
      out << "Newton stopped after " << r.iterations << " iterations, residual " << r.last.relative << " > "
          << settings.tolerance;
      break;
    case NewtonStatus::stalled:
      if (r.last.relative > settings.tolerance)
        out << "Newton found no better state along its direction, residual " << r.last.relative << " > "
            << settings.tolerance;
      else
        out << "the prescribed motion could not be carried out: elements or points would turn inside out";
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
