#pragma once

#include "core/math/mat3.hpp"
#include "core/physics/law_constants.hpp"

namespace fascia {

/// Whether St Venant-Kirchhoff's law resists every deformation m ⊗ n that is added to F: whether for all directions n
///   Q(n) = (n · S n) I + F [(λ + μ) n nᵀ + μ I] Fᵀ,   S = λ tr E I + 2μ E,   E = ½ (FᵀF − I)
/// is positive definite (strong ellipticity). Where it is not, bands across n deform further without resistance, and
/// an equilibrium there is not stable, whatever holds the body. A bar comes to that where it is pressed to 0.59 of its
/// length (ν = 0.3), a free face where it is sheared by 1; a pull and a shear between walls never do.
///
/// Directions in the three principal planes are looked at, every ten degrees: false is a proof, true is none.
/// @return true  also of an F that is not finite
bool is_strongly_elliptic(const Lame& constants, const Mat3d& F);

}  // namespace fascia
