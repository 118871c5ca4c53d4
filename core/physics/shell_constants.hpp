#pragma once

namespace fascia {

/// Entries of a symmetric 6 × 6 matrix on and below the diagonal, by rows.
inline constexpr int kPacked6 = 21;

/// Constants of a shell's triangle at rest (core/physics/shell_triangle.hpp).
template <class T>
struct ShellConstants {
  T g[3][2]{};             ///< gradients of the linear functions at rest [1/m]
  T membrane[kPacked6]{};  ///< of (E₁₁, E₂₂, 2E₁₂, θ_1z, θ_2z, θ_3z) [J]
  T bending[kPacked6]{};   ///< of (θ_1x, θ_1y, θ_2x, ...) [J]
};

}  // namespace fascia
