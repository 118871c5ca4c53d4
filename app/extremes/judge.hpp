#pragma once

#include "app/extremes/cells.hpp"
#include "app/extremes/other_units.hpp"
#include "app/study/child_run.hpp"

#include <optional>
#include <string>

namespace fascia::app {

/// How a cell ended, from the best to the worst. Up to `stopped` nobody is led astray.
enum class CellVerdict {
  right,        ///< converged, and the twin agrees; of what nothing holds: refused, with that reason
  beyond,       ///< exit 3 where the law bears less than the cell asks, by a closed form, and says so
  sensitive,    ///< converged and differs from the twin, as it does when forces change by the residual allowed
  branch,       ///< converged to another solution than the twin: it stays where it is when the tolerance is smaller
  warned,       ///< converged and differs from the twin, and the run itself warns that there may be other solutions
  refused,      ///< exit 2, before anything was computed, with a reason
  stopped,      ///< exit 3, with a reason
  unconfirmed,  ///< converged, but the twin did not
  limit,        ///< took longer or more memory than a cell may
  wrong,        ///< converged, and the twin differs
  crashed       ///< any other end, no reason, or a number that is none
};
std::string name_of(CellVerdict verdict);
/// @return none  no such name
std::optional<CellVerdict> verdict_of(std::string_view name);

/// True where a user would take a wrong answer for a right one, or gets none in time.
inline bool leads_astray(CellVerdict v) { return v > CellVerdict::stopped; }

struct CellOutcome {
  CellVerdict verdict = CellVerdict::crashed;
  std::string status;                  ///< of the run: "converged", "unstable", "refused"
  std::string reason;                  ///< its message, or what is wrong
  std::optional<double> difference;    ///< largest of the probes, relative, to the twin
  std::optional<double> theory_error;  ///< relative, of the tip, to the theory of beams
  std::optional<double> size;          ///< largest number of the probes in metres [m]
  double seconds = 0;                  ///< that the run took
};

/// Two converged runs must not differ by more.
inline constexpr double kAllowedDifference = 1e-6;

/// Forces below this part of E A, and displacements below this part of the length, count as none: a body that moves
/// rigidly by its own size has stresses of rounding, 1e-16 of E.
inline constexpr double kNothing = 1e-9;

/// A cell's run and those that it is judged by; the twin is the same scene in other units, see twin.hpp.
struct CellRuns {
  const ChildResult* run;
  const ChildResult* twin;       ///< exit status -1: not run
  const ChildResult* disturbed;  ///< likewise
  const ChildResult* sharper;    ///< likewise: the cell's own scene to a hundredth of the tolerance
  UnitFactors units;             ///< of the twins
};
CellOutcome judge(const ExtremeCell& cell, const CellRuns& runs);

}  // namespace fascia::app
