#pragma once

#include "core/physics/st_venant_kirchhoff.hpp"

namespace fascia {

/// Linear elasticity, ψ = λ/2 (tr ε)² + μ ε:ε of ε = sym H  [J/m³]: of small strains and rotations, with the stress
/// that St Venant and Kirchhoff have of theirs. P = S.
template <class T>
struct SmallStrain : StVenantKirchhoff<T> {
  static constexpr bool kSmall = true;

  FASCIA_HD static Mat3<T> strain(const Mat3<T>& H) { return sym(H); }
  FASCIA_HD static T volumetric_strain(const Mat3<T>& H) { return trace(sym(H)); }
  FASCIA_HD static Mat3<T> volumetric_gradient(const Mat3<T>&) { return Mat3<T>::identity(); }
  FASCIA_HD T shear_energy(const Mat3<T>& H) const {
    const Mat3<T> E = sym(H);
    return this->mu * contract(E, E);
  }
};

}  // namespace fascia
