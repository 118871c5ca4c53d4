#pragma once

#include "core/linear/cg.hpp"

#include <functional>
#include <memory>

namespace fascia {

class LinearSolver;
class TangentOperator;

enum class LinearMethod { automatic, cg, cholesky };
enum class PreconditionerKind { automatic, none, jacobi, block_jacobi, multigrid, cholesky };

/// Arithmetic of Newton's directions; residuals, states and energies are of 64 bits always, and so what a converged run
/// is judged by. mixed: products with the tangent of 32 bits; single: vectors of conjugate gradients too, on the GPU
/// alone. Sums over nodes are of 64 bits. On the processor a product of 32 bits has entries of the tangent rounded to
/// them, and conjugate gradients alone take it.
enum class Precision { full, mixed, single };

/// How systems with the tangent are solved.
struct LinearSettings {
  LinearMethod linear = LinearMethod::automatic;
  PreconditionerKind preconditioner = PreconditionerKind::automatic;
  CgOptions cg;
  Precision precision = Precision::full;
  /// Makes a solver of the caller's own, which takes the place of these; empty: none. Systems of the processor ask it.
  /// Where it cannot take a tangent, and on paths past limit points, a factor of ours does.
  std::function<std::unique_ptr<LinearSolver>(TangentOperator& K)> own;
};

}  // namespace fascia
