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
  std::string kind;         ///< "frames" of a grid, "scattered", "affine", "tetrahedra", "tetrahedra-2", "hexahedra",
                            ///< "hexahedra-2", "shell"
  bool factorised = false;  ///< by Cholesky; else conjugate gradients
  bool dynamics = false;
  int threads = 1;
  double points = 0, unknowns = 0;
  double newton = 0, linear = 0;  ///< iterations of the run; linear: of conjugate gradients
  double courant = 0;             ///< of its implicit steps, as LinearUse has it
  double explicit_steps = 0;      ///< 0: others
  double setup = 0, solve = 0;    ///< [s]
};

/// What a kind of body costs on one thread of this machine.
///
///   Newton iteration = point P + { factor U^exponent | product U n },   set-up = start + setup_point P
///
/// with P integration points, U unknowns and n iterations of conjugate gradients: spread U^(1/d) in dimension d; of an
/// implicit step at Courant number C the fewer of these and of 2 + wave C. An explicit step of a given length takes
/// explicit_point P.
struct KindCost {
  double point = 0;                         ///< [s]
  double factor = 0, exponent = 1.5;        ///< [s], [-]
  double product = 0, spread = 10;          ///< [s], [-]
  double wave = 8;                          ///< [-]
  double explicit_point = 0;                ///< [s]
  double start = 0, setup_point = 0;        ///< [s]
  double step = 1;                          ///< an iteration of an implicit step over what its parts take
  double kept = 1;                          ///< the same, where a factor is kept from solve to solve
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

/// The kind of costs that a body has: "hexahedra-2". Nobody times "scattered-affine".
std::string cost_kind(const Body& body);

/// How tangents of a run are solved.
struct LinearUse {
  LinearMethod method = LinearMethod::automatic;
  int dimension = 3;          ///< of the body
  double courant = 0;         ///< of implicit steps: speed of pressure waves × step / distance of nodes; 0: statics
  bool blocks_first = false;  ///< the choice is the program's, and inertia lets it try conjugate gradients first, and
                              ///< keep a factor from solve to solve
};
/// @param conservative  loads have a potential
LinearUse linear_use(const Solver& solver, int dimension, double courant, bool conservative);

/// What the linear solve of a Newton iteration takes on one thread.
struct LinearCost {
  double seconds = 0;
  bool factorised = false;
};
LinearCost linear_cost(const KindCost& cost, double unknowns, const LinearUse& use);

/// Courant number of a scene's implicit steps, the largest of its bodies; 0 in statics.
double courant_of(const Simulation& simulation);

/// Time of a scene's run [s], without what it writes: 5 Newton iterations for a static solve (1 where all is linear),
/// 2 for an implicit step. None where a body's kind was not timed.
struct TimeForecast {
  double seconds = 0;
  double iterations = 0;  ///< of Newton's method, as assumed; of explicit dynamics: steps
};
std::optional<TimeForecast> forecast_time(const Simulation& simulation, const CostModel& costs);

}  // namespace fascia::app
