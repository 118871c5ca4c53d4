#pragma once

#include "core/physics/point_rule.hpp"
#include "core/physics/solid_law.hpp"

#include <type_traits>

/// Elastic laws of points: a solid's, and those of points that stand for a slice through a sheet or along a line, whose
/// stress has no component across (docs/notation.md).
namespace fascia {

/// Shear correction of a sheet's transverse shear.
inline constexpr double kSheetShear = 5.0 / 6.0;

template <class T>
struct PointMaterial {
  T volume, lambda, mu;  ///< [m³], [Pa], [Pa]; of thin laws see thin_lame()
  T stabilization;       ///< γ [Pa]
  T viscosity;           ///< κ = β/dt [-]: viscous stress κ C : (E − E_old)
};

template <Law L, class T>
struct SolidMaterial : PointMaterial<T>, OwnConstants<SolidLaw<L, T>::kOwn, T> {
  FASCIA_HD SolidLaw<L, T> law() const { return make_law<SolidLaw<L, T>>(*this); }
};

/// Material of a sheet, a line or a tether. It has a type of its own, so that solids do not ask at every point which
/// law they have.
template <class T>
struct ThinMaterial : PointMaterial<T> {
  Law law = Law::sheet;
  bool transverse = false;  ///< as in PointRule
  Mat3<T> axes;             ///< columns: tangents first; tether: stiffness [N/m]
  Vec3<T> target;           ///< tether: where to [m]
};

/// Type of a material whose law the compiler knows.
template <Law L, class T>
using MaterialOf = std::conditional_t<is_thin(L), ThinMaterial<T>, SolidMaterial<L, T>>;

template <class T>
FASCIA_HD constexpr bool is_tether(const PointMaterial<T>&) {
  return false;
}
template <class T>
FASCIA_HD constexpr bool is_tether(const ThinMaterial<T>& m) {
  return m.law == Law::tether;
}

/// The two constants of a thin law, S_tt = λ' tr_t(E) + 2μ E_tt in its tangent directions: a sheet's λ' = 2λμ/(λ + 2μ)
/// makes plane stress, a line's λ' = E − 2μ makes S₁₁ = E E₁₁.
FASCIA_HD constexpr Lame thin_lame(Law law, const Lame& m) {
  if (law == Law::sheet) return {2 * m.lambda * m.mu / (m.lambda + 2 * m.mu), m.mu};
  if (law == Law::line) return {m.young() - 2 * m.mu, m.mu};
  return m;
}

/// Second Piola-Kirchhoff stress of a thin law: tangent directions as above, transverse shear 2 k μ E with k = 5/6 for
/// a sheet and 1 for a disc, nothing across unless `transverse` (then 2μ E, uncoupled).
template <class T>
FASCIA_HD Mat3<T> second_piola(const ThinMaterial<T>& m, const Mat3<T>& E) {
  const int tangents = m.law == Law::sheet ? 2 : 1;
  const T shear = m.law == Law::sheet ? T(kSheetShear) : T(1.0), across = m.transverse ? T(1.0) : T(0.0);
  const Mat3<T> local = transpose_times(m.axes, E * m.axes);
  Mat3<T> S;
  T stretch = local(0, 0);
  if (tangents == 2) stretch += local(1, 1);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const bool in_i = i < tangents, in_j = j < tangents;
      S(i, j) = local(i, j) * (m.mu * T(2.0));
      if (in_i != in_j) S(i, j) *= shear;
      if (!in_i && !in_j) S(i, j) *= across;
    }
    if (i < tangents) S(i, i) += m.lambda * stretch;
  }
  return m.axes * times_transpose(S, m.axes);
}

/// S of a strain [Pa]; linear, so it also maps dE to dS. Viscous stress is of this form whatever the law.
template <class T>
FASCIA_HD Mat3<T> second_piola(const PointMaterial<T>& m, const Mat3<T>& E) {
  return StVenantKirchhoff<T>{m.lambda, m.mu}.second_piola(E);
}

/// Elastic and viscous S at H, whose strain is E  [Pa].
template <class T>
FASCIA_HD Mat3<T> stress(const ThinMaterial<T>& m, const Mat3<T>&, const Mat3<T>& E, const Mat3<T>& E_old) {
  return second_piola(m, E + (E - E_old) * m.viscosity);
}
template <Law L, class T>
FASCIA_HD Mat3<T> stress(const SolidMaterial<L, T>& m, const Mat3<T>& H, const Mat3<T>& E, const Mat3<T>& E_old) {
  if constexpr (L == Law::st_venant_kirchhoff)  // linear in the strain: one product for both
    return second_piola(m, E + (E - E_old) * m.viscosity);
  else
    return second_piola(m.law(), H) + second_piola(m, (E - E_old) * m.viscosity);
}

/// Elastic and viscous dS of dE at H  [Pa].
template <class T>
FASCIA_HD Mat3<T> stress_differential(const ThinMaterial<T>& m, const Mat3<T>&, const Mat3<T>& dE) {
  return second_piola(m, dE) * (T(1) + m.viscosity);
}
template <Law L, class T>
FASCIA_HD Mat3<T> stress_differential(const SolidMaterial<L, T>& m, const Mat3<T>& H, const Mat3<T>& dE) {
  if constexpr (L == Law::st_venant_kirchhoff)
    return second_piola(m, dE) * (T(1) + m.viscosity);
  else
    return second_piola_differential(m.law(), H, dE) + second_piola(m, dE) * m.viscosity;
}

/// ψ = E : S(E) / 2  [J/m³]; of viscous stress too.
template <class T>
FASCIA_HD T energy_density(const PointMaterial<T>& m, const Mat3<T>& E) {
  return StVenantKirchhoff<T>{m.lambda, m.mu}.energy_density(E);
}
template <class T>
FASCIA_HD T energy_density(const ThinMaterial<T>& m, const Mat3<T>& E) {
  return T(0.5) * contract(E, second_piola(m, E));
}

/// Elastic ψ at H, whose strain is E  [J/m³].
template <class T>
FASCIA_HD T elastic_energy(const ThinMaterial<T>& m, const Mat3<T>&, const Mat3<T>& E) {
  return energy_density(m, E);
}
template <Law L, class T>
FASCIA_HD T elastic_energy(const SolidMaterial<L, T>& m, const Mat3<T>& H, const Mat3<T>& E) {
  if constexpr (L == Law::st_venant_kirchhoff)
    return energy_density(m, E);
  else
    return energy_density(m.law(), H);
}

}  // namespace fascia
