#pragma once

#include "core/physics/shell_constants.hpp"

#include <array>

namespace fascia {

/// Corners of a triangle in its plane [m], counter-clockwise.
using PlaneTriangle = std::array<std::array<double, 2>, 3>;

/// What a shell is made of: isotropic, plane stress.
struct ShellSection {
  double young = 0, poisson = 0;  ///< [Pa], [-]
  double thickness = 0;           ///< [m]
  double tilt = 0;                ///< mean square angle between the triangle and the surface at its corners [rad²]
};

/// Stiffness of a triangle against its 12 strains: a membrane that bends exactly in its plane, and a plate that is
/// exact in the limit of a thin one and deforms in shear.
///
/// Membrane: the optimal triangle with drilling rotations, OPT (Felippa, Comput. Methods Appl. Mech. Eng. 192 (2003)
/// 2125, section 5): mean strain of edges that bulge with the rotations (α = 3/2), and deviations from it that make
/// the energy of bending in the plane right (β₀ = (1 − 4ν²)/2, at least 0.01), reduced where the surface is curved:
/// β = β₀ / (1 + 100 tilt A/t²), at least 0.01 β₀ (docs/decisions/shell_formulation.md).
///
/// Bending: the discrete Kirchhoff-Mindlin triangle DKMT (Katili, Int. J. Numer. Methods Eng. 36 (1993) 1859): the
/// normal turns quadratically along edges, as much as the shear of the edge in equilibrium with the bending moments
/// leaves it.
ShellConstants<double> shell_stiffness(const PlaneTriangle& corners, const ShellSection& section);

/// Gradients of the linear functions, and the area.
struct LinearGradients {
  double area = 0;
  std::array<std::array<double, 2>, 3> g{};
};
LinearGradients linear_gradients(const PlaneTriangle& corners);

/// Curvatures and shear strains at a place, by the rotations (θ_1x, θ_1y, ...) of the corners.
struct PlateStrains {
  double curvature[3][6]{};  ///< κ₁₁, κ₂₂, 2κ₁₂ [1/m]
  double shear[2][6]{};      ///< γ₁₃, γ₂₃ [-]
};
/// @param L  barycentric coordinates
PlateStrains plate_strains(const PlaneTriangle& corners, const ShellSection& section, const std::array<double, 3>& L);

/// Mean membrane strain E₁₁, E₂₂, 2E₁₂ for unit drilling rotations of the corners.
std::array<std::array<double, 3>, 3> drilling_strains(const PlaneTriangle& corners);

/// Plane-stress stiffness of E₁₁, E₂₂, 2E₁₂ [Pa].
std::array<std::array<double, 3>, 3> plane_stress(const ShellSection& section);

}  // namespace fascia
