#pragma once

#include "core/base/portability.hpp"
#include "core/math/mat3.hpp"

#include <cmath>
#include <memory>
#include <vector>

namespace fascia {

/// A part of a law's stress that fades.
struct ViscousBranch {
  double share = 0;  ///< of the instantaneous stress [-]
  double time = 0;   ///< τ, after which 1/e of it is left [s]

  friend bool operator==(const ViscousBranch&, const ViscousBranch&) = default;
};

/// Linear viscoelasticity beside any law of solids: its stress S_e, with the constants that it is given, is the
/// instantaneous one, of which shares fade (a Prony series; Holzapfel 2000, section 6.10),
///
///   S = (1 − Σ g) S_e + Σ Q,   dQ/dt + Q/τ = g dS_e/dt   for each branch.
///
/// A step of length h along which S_e grows evenly gives, without error,
///
///   Q = d Q₀ + g r (S_e − S_e₀),   d = exp(−h/τ),   r = (1 − d) τ/h,
///
/// so that S = c S_e + S₀ with c = 1 − Σ g (1 − r) and S₀ = Σ (d Q₀ − g r S_e₀): a law with factors on its constants,
/// since stresses are linear in these, and a stress that stays as it is during the step.
struct Viscosity {
  std::vector<ViscousBranch> branches;
  bool shear_only = false;             ///< S_e is that of the shear modulus alone; the bulk modulus does not fade
  bool instantaneous_statics = false;  ///< statics are over before anything fades; else they wait until all has

  double long_term() const {
    double share = 1;
    for (const ViscousBranch& b : branches) share -= b.share;
    return share;
  }
  friend bool operator==(const Viscosity&, const Viscosity&) = default;
};

/// The least part of a stiffness that must last: below, its digits are those of the shares.
inline constexpr double kLeastLasting = 1e-6;

/// Two materials fade alike, or neither does.
inline bool fade_alike(const std::shared_ptr<const Viscosity>& a, const std::shared_ptr<const Viscosity>& b) {
  return a == b || (a && b && *a == *b);
}

/// Factors on what a law is made of: μ and its own constants, and the bulk modulus.
template <class T>
struct LawFactors {
  T shear, bulk;
};

/// @tparam Record  with lambda, mu and, where the law has its own, `own`
template <class Record, class T>
FASCIA_HD void scale_constants(const LawFactors<T>& factors, Record& m) {
  const T shear = m.mu * T(2.0 / 3);  // K = λ + 2μ/3
  m.lambda = (m.lambda + shear) * factors.bulk - shear * factors.shear;
  m.mu = m.mu * factors.shear;
  if constexpr (requires { m.own[0]; })
    for (auto& constant : m.own) constant = constant * factors.shear;
}

/// A step leaves a branch the part d, and adds g r of the growth of S_e.
struct BranchStep {
  double decay = 1, gain = 0;

  static BranchStep of(const ViscousBranch& branch, double h) {
    const double x = h / branch.time;  // infinite: d = r = 0
    if (x == 0) return {1, branch.share};
    return {std::exp(-x), std::isinf(x) ? 0.0 : -branch.share * std::expm1(-x) / x};
  }
};

}  // namespace fascia
