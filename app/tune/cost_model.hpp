#pragma once

#include "assembly/simulation/simulation.hpp"

#include <nlohmann/json.hpp>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// A timed run of one body.
struct CostSample {
  std::string kind;         ///< "frames", "affine", "tetrahedra", "tetrahedra-2", "hexahedra", "hexahedra-2", "shell"
  bool factorised = false;  ///< by Cholesky; else conjugate gradients
  bool dynamics = false;
  int threads = 1;
  double points = 0, unknowns = 0;
  double newton = 0, linear = 0;  ///< iterations of the run; linear: of conjugate gradients
  double setup = 0, solve = 0;    ///< [s]
};

/// What a kind of body costs on one thread of this machine.
///
///   Newton iteration = point P + { factor U^exponent | product U n },   set-up = start + setup_point P
///
/// with P integration points, U unknowns, n = spread U^(1/d) iterations of conjugate gradients, d the dimension.
struct KindCost {
  double point = 0;                         ///< [s]
  double factor = 0, exponent = 1.5;        ///< [s], [-]
  double product = 0, spread = 10;          ///< [s], [-]
  double start = 0, setup_point = 0;        ///< [s]
  double step = 1;                          ///< an iteration of an implicit step over one of statics
  double faster_factor = 1, faster_cg = 1;  ///< on all threads
};

struct CostModel {
  std::map<std::string, KindCost> kinds;

  nlohmann::ordered_json json() const;
  /// @return none where it is not what json() writes
  static std::optional<CostModel> read(const nlohmann::ordered_json& json);
};

/// Fits every kind that has runs of two sizes by both linear solvers.
CostModel fitted_costs(const std::vector<CostSample>& samples);

/// The kind of costs that a body has: "hexahedra-2".
std::string cost_kind(const Body& body);

/// Up to so many unknowns stiffness is factorised where the scene does not say how.
bool factorises(const Solver& solver, double unknowns);

/// Time of an iteration's linear solve on one thread [s]. @param dimension  of the body
double linear_solve_time(const KindCost& cost, double unknowns, bool factorised, int dimension);

/// Time of a scene's run [s], without what it writes: 5 Newton iterations for a static solve (1 where all is linear),
/// 2 for an implicit step. None where a body's kind was not timed.
struct TimeForecast {
  double seconds = 0;
  double iterations = 0;  ///< of Newton's method, as assumed; of explicit dynamics: steps
};
std::optional<TimeForecast> forecast_time(const Simulation& simulation, const CostModel& costs);

}  // namespace fascia::app
