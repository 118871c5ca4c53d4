#pragma once

#include "core/base/portability.hpp"
#include "core/physics/active_stress.hpp"
#include "core/physics/viscosity.hpp"

#include <memory>
#include <vector>

namespace fascia {

/// Lamé's constants, from a Young modulus [Pa] and a Poisson ratio in (−1, ½) and back.
struct Lame {
  double lambda = 0, mu = 0;  ///< [Pa]

  FASCIA_HD static constexpr Lame from_young(double young, double poisson) {
    return {young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))};
  }
  FASCIA_HD static constexpr Lame from_bulk(double bulk, double mu) { return {bulk - 2 * mu / 3, mu}; }
  FASCIA_HD constexpr double young() const { return mu * (3 * lambda + 2 * mu) / (lambda + mu); }
  FASCIA_HD constexpr double poisson() const { return lambda / (2 * (lambda + mu)); }
  /// Modulus of waves of compression: λ + 2μ.
  FASCIA_HD constexpr double wave_modulus() const { return lambda + 2 * mu; }

  friend constexpr bool operator==(const Lame&, const Lame&) = default;
};

/// Constants of a law of solids at a point. All laws have Lamé's, of small strain, from which damping, ties, estimates
/// of stiffness and rounding are made; a law that needs more has them of its own, in its own order.
struct LawConstants : Lame {
  std::vector<double> own{};
  std::shared_ptr<const Viscosity> viscosity{};  ///< shares of the stress that fade; null where none does
  std::shared_ptr<const ActiveStress> active{};  ///< null where nothing acts by itself

  friend bool operator==(const LawConstants& a, const LawConstants& b) {
    return static_cast<const Lame&>(a) == b && a.own == b.own && fade_alike(a.viscosity, b.viscosity) &&
           act_alike(a.active, b.active);
  }
};

/// The own constants of a law in a kernel: none, or `own[N]`.
template <int N, class T>
struct OwnConstants {
  T own[N];
};
template <class T>
struct OwnConstants<0, T> {};

/// The law that a record of constants makes. @tparam Record  with lambda, mu and, where the law has its own, `own`
template <class Solid, class Record>
FASCIA_HD Solid make_law(const Record& m) {
  Solid law;
  law.lambda = m.lambda;
  law.mu = m.mu;
  if constexpr (Solid::kOwn > 0)
    for (int k = 0; k < Solid::kOwn; ++k) law.own[k] = m.own[k];
  return law;
}

}  // namespace fascia
