#pragma once

#include "core/physics/st_venant_kirchhoff.hpp"

namespace fascia {

/// Linear elasticity, ψ = λ/2 (tr ε)² + μ ε:ε of ε = sym H  [J/m³]: of small strains and rotations. P = S.
template <class T>
struct SmallStrain {
  static constexpr bool kSmall = true;
  T lambda, mu;  ///< [Pa]

  struct At {
    FASCIA_HD explicit At(const Mat3<T>&) {}
    At() = default;
  };
  FASCIA_HD static Mat3<T> strain(const Mat3<T>& H) { return sym(H); }
  FASCIA_HD static T volumetric_strain(const Mat3<T>& H) { return trace(sym(H)); }
  FASCIA_HD static Mat3<T> volumetric_gradient(const Mat3<T>&) { return Mat3<T>::identity(); }
  FASCIA_HD T shear_energy(const Mat3<T>& H) const {
    const Mat3<T> E = sym(H);
    return mu * contract(E, E);
  }
  FASCIA_HD Mat3<T> second_piola(const At&, const Mat3<T>& E, const T& p) const {
    return E * (T(2) * mu) + Mat3<T>::diagonal(p);
  }
  FASCIA_HD Mat3<T> second_piola_differential(const At&, const T&, const Mat3<T>& dE, bool /*full*/) const {
    return StVenantKirchhoff<T>{lambda, mu}.second_piola(dE);
  }
};

}  // namespace fascia
