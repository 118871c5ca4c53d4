#pragma once

#include "core/linear/cg.hpp"

#include <functional>
#include <memory>

namespace fascia {

class LinearSolver;
class TangentOperator;

enum class LinearMethod { automatic, cg, cholesky };
enum class PreconditionerKind { automatic, none, jacobi, block_jacobi, multigrid, cholesky };

/// How systems with the tangent are solved.
struct LinearSettings {
  LinearMethod linear = LinearMethod::automatic;
  PreconditionerKind preconditioner = PreconditionerKind::automatic;
  CgOptions cg;
  /// Makes a solver of the caller's own, which takes the place of these; empty: none. Systems of the processor ask it.
  /// Where it cannot take a tangent, and on paths past limit points, a factor of ours does.
  std::function<std::unique_ptr<LinearSolver>(TangentOperator& K)> own;
};

}  // namespace fascia
