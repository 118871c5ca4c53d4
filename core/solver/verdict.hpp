#pragma once

#include "core/structure/model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace fascia {

/// Squares of norms of what acts on one part of a model (model/parts.hpp), torques divided by the part's length [N²].
/// Loads on what a constraint holds are in neither `load` nor `reaction`: they go into the support, however large, and
/// say nothing of what is left to balance.
struct PartForces {
  double residual = 0, load = 0, inertia = 0, reaction = 0, tether = 0;
  double momentum = 0;  ///< of what cancels in the inertia: mass times motion over the step's square
  double rounding = 0;  ///< estimate of what rounding alone leaves in the residual: a norm, no square [N]
  bool adrift = false;  ///< nothing holds or loads it, and it moves: its momentum is what there is to keep
  bool driven = false;  ///< a boundary motion moves the whole that it belongs to, see driven_parts()
};

/// Square of a part's load; none where it is what rounding leaves of loads that constraints with axes of their own
/// carry.
/// @param turned  square of those
inline double squared_load(double load, double turned) {
  constexpr double kTurn = 8 * std::numeric_limits<double>::epsilon();
  return load > kTurn * kTurn * turned ? load : 0.0;
}

/// A system at a state, in numbers. Residuals are norms with torques divided by a length [N]. Each part of the model is
/// judged by itself, so that a stiff or heavy neighbour does not hide what is left in a soft one.
struct Evaluation {
  double energy = 0;          ///< potential that an equilibrium minimises [J]
  double energy_scale = 0;    ///< sum of the sizes of its terms [J]
  double residual = 0;        ///< of all free degrees of freedom
  double excess = 0;          ///< largest of the parts: residual over what is allowed; at most 1 where converged
  double relative = 0;        ///< that part's residual over what acts on its whole (judge()), or rounding
  double relative_floor = 0;  ///< what rounding leaves of it, likewise
  double left_of_load = 0;    ///< largest of the parts: residual over its loads, or over what acts where there are none
  bool by_rounding = false;   ///< some part is above the tolerance and allowed by its rounding alone
  double strain_energy = 0;   ///< elastic, of statics [J]; 0: not known
  /// There is one part, loads act on it, and rounding, which may leave what is left, is less than a tenth of them:
  /// where corrections are small too, the state is as good as these numbers can make it.
  bool within_rounding = false;

  bool finite() const { return std::isfinite(energy) && std::isfinite(residual); }
  bool converged() const { return excess <= 1; }
};

/// No residual above this part of a part's loads is called converged for another reason than the tolerance itself.
inline constexpr double kLargestShare = 1e-4;
/// Rounding that is a larger part of the loads hides how a structure resists them: stiffness has no digits left.
inline constexpr double kMostRounding = 0.1;
/// Factor by which what acts exceeds the rounding floor where it is told from rounding.
inline constexpr double kAboveRounding = 100;

/// A free part that moves in a step by less than this part of its displacement is at rest but for rounding.
inline constexpr double kAtRest = 1e-4;

/// √Σ m² over the nodes of each part [kg]: with it a motion of all nodes is as large as the forces of PartForces.
std::vector<double> part_masses(const Model& model);

/// Parts whose whole a boundary motion moves (true), by a support or by a tether. What moves them shows in reactions
/// alone. Where loads do, reactions say less: bending makes them larger than the load by length over thickness.
std::vector<char> driven_parts(const Model& model);

/// Judges the residuals of all parts; fills what Evaluation says of them.
///
/// A part is in equilibrium where its residual is at most
///   - tolerance × the largest of its own load and inertia, or
///   - tolerance × the largest load or inertia in the whole that it belongs to (reactions and tethers count where a
///     motion drives it, or nothing else acts), but at most kLargestShare × its load,
///   - or its rounding floor, as far as that excuses it: never more than kLargestShare × its load.
///
/// @param whole  of each part (PointSet::part_whole)
void judge(std::span<const PartForces> parts, std::span<const int> whole, double tolerance, Evaluation& e);

}  // namespace fascia
