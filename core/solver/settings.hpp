#pragma once

#include "core/physics/point_physics.hpp"
#include "core/tangent/linear_settings.hpp"

#include <functional>
#include <vector>

namespace fascia {

/// Where a solve stands when a Newton iteration begins.
struct IterationInfo {
  int step = 0;                        ///< load or time step, counted from 1
  double time = 0;                     ///< its end [s]; in statics the load factor
  int iteration = 0;                   ///< counted from 1
  double relative = 0, tolerance = 0;  ///< the residual before it, relative, and where it is small enough
};

/// GPUs that can share a run.
inline constexpr int kMostDevices = 8;

struct SolverSettings : LinearSettings {
  int max_iterations = 50;        ///< Newton iterations of a load or time step
  double tolerance = 1e-8;        ///< residual relative to what acts, see judge()
  bool proceed_on_limit = false;  ///< go on with the residual reached
  double budget = 0;              ///< of implicit dynamics: time that a step may take [s]; 0: as long as it needs
  Tangent tangent = Tangent::full;
  std::function<void(const IterationInfo&)> iterating;  ///< is told of each Newton iteration; may be empty
  std::function<bool()> stops;                          ///< asked before each: true ends the solve; may be empty
  int threads = 0;                                      ///< of the processor, for what it does beside a GPU; 0: all
  std::vector<int> devices;  ///< GPUs that share the points of the linear solves; empty: one computes all
};

}  // namespace fascia
