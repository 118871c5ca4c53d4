#pragma once

#include "core/node/dof_filter.hpp"
#include "core/structure/model.hpp"

#include <cmath>
#include <functional>
#include <span>
#include <vector>

namespace fascia {

/// Stability of an equilibrium under dead loads, as the tangent K there tells it.
struct Stability {
  bool known = false;       ///< false: nobody looked, or the linear solver found no answer
  int unstable = 0;         ///< directions in which the energy falls; of conjugate gradients 1 stands for any number
  bool near_limit = false;  ///< the softest direction has lost all but kNearLimit of its stiffness at rest, or more
  int node = -1;            ///< that moves most in the softest direction

  bool is_unstable() const { return known && unstable > 0 && !near_limit; }
};

/// Within this part of the lowest stiffness at rest the sign of the present one is not what a model can tell.
inline constexpr double kNearLimit = 0.01;

/// Outcome of a solve with a tangent.
struct TangentProbe {
  bool usable = false;
  int unstable = 0;  ///< negative directions that it met
};
/// Solves K x = b; vectors by degrees of freedom in constraint axes, prescribed and dependent entries zero.
using ProbeSolve = std::function<TangentProbe(std::span<const double> b, std::span<double> x)>;

/// The direction in which a tangent resists least.
struct SoftestDirection {
  TangentProbe probe;
  double stiffness = 0;           ///< x · K x / x · W x [N/m]
  std::vector<double> direction;  ///< in constraint axes
};

/// W: what displacements and rotations of each degree of freedom count, 1 and the squared length of the node's part
/// [m²]; 0 of what is prescribed and of dependent nodes.
std::vector<double> motion_weights(const Model& model, const DofFilter& filter);
/// Their roots [m].
std::vector<double> motion_lengths(const Model& model, const DofFilter& filter);

/// Polynomials of low degree in the rest position with random coefficients, and a little of noise: a motion that has a
/// share of every softest direction.
std::vector<double> smooth_motion(const Model& model);

/// Inverse iteration x ← K⁻¹ W x from a smooth random motion, which has a share of every softest direction: a load that
/// is symmetric never shows the direction in which a straight column buckles.
///
/// @param rounds  solves; each brings the quotient nearer to the eigenvalue of least size
SoftestDirection softest_direction(const Model& model, const DofFilter& filter, const ProbeSolve& solve, int rounds);

/// x · K x / x · W x of a product in constraint axes.
double quotient(std::span<const double> x, std::span<const double> Kx, std::span<const double> weights);

/// The node that moves most.
int most_moved_node(const Model& model, std::span<const double> direction);

/// Stability of the equilibrium that a system stands at after an evaluation; it stands there again in the end.
///
/// @param softest  softest(at_end): the softest direction of the full tangent at the state of the last evaluation
template <class System, class Softest>
Stability stability_of(System& system, const typename System::Pose& end, const typename System::Pose& rest,
                       const Softest& softest) {
  Stability out;
  if (system.filter().free_count() == 0) {
    out.known = true;
    return out;
  }
  const SoftestDirection now = softest(true);
  if (!now.probe.usable) {
    system.evaluate();
    return out;
  }
  out.known = true;
  out.unstable = now.probe.unstable;
  std::vector<double> direction = now.direction;
  system.filter().to_global(direction);
  out.node = most_moved_node(system.model(), direction);

  // The stiffness of this direction at rest bounds the lowest one there from above: most ends need no more.
  const std::vector<double> factors(system.factors().begin(), system.factors().end());
  system.begin_step(rest, 0);
  system.set_rest();
  system.evaluate();
  std::vector<double> y = system.product(direction);
  system.filter().to_local(y);
  const double bound = quotient(now.direction, y, motion_weights(system.model(), system.filter()));
  if (std::abs(now.stiffness) <= kNearLimit * bound) {
    const SoftestDirection at_rest = softest(false);
    out.near_limit = at_rest.probe.usable && std::abs(now.stiffness) <= kNearLimit * std::abs(at_rest.stiffness);
  }
  system.begin_step(end, 0);
  system.set_factors(factors);
  system.evaluate();
  return out;
}

}  // namespace fascia
