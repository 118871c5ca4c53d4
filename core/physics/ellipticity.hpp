#pragma once

#include "core/math/mat3.hpp"
#include "core/physics/law_constants.hpp"

namespace fascia {

/// Tells whether St Venant-Kirchhoff's law resists every deformation m ⊗ n that is added to F: for all directions n
///   Q(n) = (n · S n) I + F [(λ + μ) n nᵀ + μ I] Fᵀ,   S = λ tr E I + 2μ E,   E = ½ (FᵀF − I)
/// is positive definite (strong ellipticity). Where it is not, bands across n deform further without resistance, and
/// an equilibrium there is not stable, whatever holds the body (Hadamard). A bar comes to that where it is pressed to
/// 0.59 of its length (ν of 0 to 0.4), a free face where it is sheared by 0.88, 1 and 1.06 (ν = 0, 0.3, 0.4), matter
/// between walls only for ν near 0 (sheared by 1.13), and a bar that is pulled never does.
///
/// Directions in the three principal planes are looked at, every ten degrees: false is a proof, true is none.
/// @return true  also of an F that is not finite
bool is_strongly_elliptic(const Lame& constants, const Mat3d& F);

}  // namespace fascia
