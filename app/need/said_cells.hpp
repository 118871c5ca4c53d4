#pragma once

#include "app/need/trials.hpp"

#include <string>
#include <vector>

namespace fascia::app {

/// Errors of the cells and frames that a scene says itself beside others that it leaves open.
struct SaidCells {
  std::vector<double> error;  ///< by quantity, relative; empty where all of the scene is open, or nothing of it
  std::string bodies;         ///< `"b", "c"`: whose cells are said
  std::string unknown;        ///< a clause: why nothing is known of them; empty where it is, or there are none

  /// The largest of the errors over those allowed.
  double ratio(const Trials& trials) const;
};

/// By a coarse trial in which these bodies alone have twice as many cells along each direction: e = d 2^p / (2^p - 1),
/// p = 2, of strains and stresses 1. @param coarse  what the bodies that are open have meanwhile
SaidCells error_of_said_cells(Trials& trials, const NeedChoice& coarse);

}  // namespace fascia::app
