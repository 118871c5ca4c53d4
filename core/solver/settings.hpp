#pragma once

#include "core/physics/point_physics.hpp"
#include "core/solver/cg.hpp"

namespace fascia {

enum class LinearMethod { automatic, cg, cholesky };
enum class Preconditioner { automatic, none, jacobi, block_jacobi, cholesky };

struct SolverSettings {
  int max_iterations = 50;        ///< Newton iterations of a load or time step
  double tolerance = 1e-8;        ///< residual relative to the largest of load, inertia and reactions
  bool proceed_on_limit = false;  ///< go on with the residual reached
  LinearMethod linear = LinearMethod::automatic;
  Preconditioner preconditioner = Preconditioner::automatic;
  CgOptions cg;
  Tangent tangent = Tangent::full;
};

}  // namespace fascia
