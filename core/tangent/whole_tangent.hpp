#pragma once

#include "core/tangent/linear_solver.hpp"
#include "core/tangent/stability.hpp"
#include "core/tangent/tangent_operator.hpp"

#include <span>

/// Tangents of loads that have no potential, which are unsymmetric: GMRES with the whole, preconditioned by any solver
/// of the symmetric part. What is left out of that acts on free edges and at points, so that few directions are new.
namespace fascia {

/// The tolerance of GMRES beside a factor, where another digit costs a product or two.
inline constexpr double kDirectTolerance = 1e-10;

/// Solves with all of K. An inner solver that iterates ends it where it finds the symmetric part indefinite.
/// @param inner       solves with the symmetric part, for which it was prepared
/// @param limit_ends  so does its limit of iterations
/// @param tolerance   on |r| / |b|
/// @return  with the iterations and negative directions of all inner solves; usable where it converged, or is nearer
///          than the symmetric part alone gets
LinearReport solve_whole(TangentOperator& K, LinearSolver& inner, bool limit_ends, std::span<const double> b,
                         std::span<double> x, double tolerance);

/// The eigenvalues of K x = λ W x next to zero, by Arnoldi's method for K⁻¹ W from a smooth random motion. A real
/// negative one is a direction in which the body leaves the equilibrium without swinging (divergence). Of complex ones,
/// and so of flutter, nothing is said: that takes the masses.
/// @param inner     a factor
/// @param definite  the symmetric part is: no real part of an eigenvalue is negative, and the softest alone is looked
///                  for
SoftestDirection softest_of_whole(TangentOperator& K, LinearSolver& inner, bool definite);

}  // namespace fascia
