#pragma once

#include "app/estimate/resolution.hpp"
#include "assembly/simulation/simulation.hpp"

#include <string>
#include <vector>

namespace fascia::app {

/// What a run beside the scene's own is for.
enum class TwinRole { finer, coarser, coarsest, shorter_step, exact, in_double };

/// A run that an estimate compares the scene's own with.
struct PlannedTwin {
  TwinRole role = TwinRole::finer;
  std::string name;  ///< "the finer twin"
  SceneTwin twin;
  double cost = 1;  ///< about how many times the time of the scene's own run
};

/// Which runs estimate the errors of a scene.
struct EstimatePlan {
  std::vector<PlannedTwin> twins;
  std::vector<std::string> notes;  ///< sentences: how an error is estimated, or why it cannot be
  double cost() const;             ///< of all, times the time of the scene's own run
};

/// Discretisation: a finer twin, with a coarser one for the order, where the finer one is small enough or asked for;
/// else two coarser ones. Time: half the step, whose scheme's order is known. Solver: tolerances of 1e-10. Precision:
/// double.
/// @throws SceneError  nothing can be estimated: modes without a frequency probe, a probe of a name that is taken
EstimatePlan plan_estimate(const Simulation& simulation);

}  // namespace fascia::app
