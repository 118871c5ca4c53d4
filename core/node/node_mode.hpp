#pragma once

#include "core/node/node_inertia.hpp"
#include "core/node/node_step.hpp"
#include "core/node/small_factor.hpp"

#include <cmath>
#include <cstdint>

/// A mode of M⁻¹ K at one node, as functions of plain values. Entries stand in constraint axes.
namespace fascia {

struct ModeNode {
  FrameKind kind = FrameKind::vertex;
  const FrameInertia* inertia = nullptr;
  Mat3d D{};                      ///< at the state
  const DofTurn* turn = nullptr;  ///< null: the axes of the world
  unsigned fixed = 0;             ///< bit k: the degree of freedom k is held
  double length = 1;              ///< of the connected part [m]

  FASCIA_HD bool is_fixed(int k) const { return (fixed >> k & 1U) != 0; }
};

/// The largest displacement, over the part's length, and rotation by which products with K move a state: small against
/// cells a ten thousandth of the part, large against rounding.
inline constexpr double kModeReach = 1e-9;

/// Vectors of a Lanczos basis that are kept.
inline constexpr int kModeBasis = 5;

/// v = M⁻¹ y on what is free, zero elsewhere and where M is singular. @return v · y
FASCIA_HD inline double solve_mass(const ModeNode& node, const double* y, double* v) {
  const int n = dof_count(node.kind);
  for (int k = 0; k < n; ++k) v[k] = node.is_fixed(k) ? 0.0 : y[k];
  if (node.kind == FrameKind::vertex) {
    const double inverse = node.inertia->mass > 0 ? 1 / node.inertia->mass : 0.0;
    for (int k = 0; k < n; ++k) v[k] *= inverse;
  } else {
    double block[kMostDofs * kMostDofs] = {};
    free_mass_block(node.kind, *node.inertia, Mat3d::identity() + node.D, node.turn, node.fixed, block);
    SmallFactor factor;
    if (factor.factorize(block, n))
      factor.solve(v);
    else
      for (int k = 0; k < n; ++k) v[k] = 0;
  }
  double product = 0;
  for (int k = 0; k < n; ++k) product += v[k] * y[k];
  return product;
}

/// Displacement over the part's length, or rotation. @param v  of the node
FASCIA_HD inline double mode_size(const ModeNode& node, const double* v) {
  const double u = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / node.length;
  const double turned = node.kind == FrameKind::vertex ? 0.0 : rotation_in(node.kind, v);
  return u > turned ? u : turned;
}

/// A number of [−√3, √3], of mean square 1.
FASCIA_HD inline double noise_of(std::uint64_t seed) {
  std::uint64_t x = seed * 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  x ^= x >> 31;
  return (2 * static_cast<double>(x >> 11) / 9007199254740992.0 - 1) * 1.7320508075688772;
}

/// Adds M^½ times noise, nearly: with its diagonal. @param seed  of the node's first entry
FASCIA_HD inline void add_mode_noise(const ModeNode& node, std::uint64_t seed, double part, double* y) {
  const int n = dof_count(node.kind);
  double block[kMostDofs * kMostDofs] = {};
  if (node.kind != FrameKind::vertex) add_inertia_block(node.kind, *node.inertia, Mat3d::identity() + node.D, block);
  for (int k = 0; k < n; ++k) {
    const double mass = node.kind == FrameKind::vertex ? node.inertia->mass : block[n * k + k];
    if (!node.is_fixed(k) && mass > 0) y[k] += part * std::sqrt(mass) * noise_of(seed + static_cast<std::uint64_t>(k));
  }
}

/// Moves a pose along a mode.
FASCIA_HD inline void move_along(const ModeNode& node, const double* v, double reach, Vec3d& u, Mat3d& D) {
  double d[kMostDofs];
  for (int k = 0; k < dof_count(node.kind); ++k) d[k] = v[k];
  if (node.turn != nullptr) turn_dofs(node.kind, node.turn->translation, node.turn->rotation, true, d);
  advance_increment(node.kind, d, reach, u, D);
}

/// w = (g − g₀) / reach, zero in what is held. @param w  g before, by degrees of freedom in world axes. @return v · w
FASCIA_HD inline double take_difference(const ModeNode& node, const double* base, const double* v, double reach,
                                        double* w) {
  const int n = dof_count(node.kind);
  for (int k = 0; k < n; ++k) w[k] = (w[k] - base[k]) / reach;
  if (node.turn != nullptr) turn_dofs(node.kind, node.turn->translation, node.turn->rotation, false, w);
  double product = 0;
  for (int k = 0; k < n; ++k) {
    if (node.is_fixed(k)) w[k] = 0;
    product += v[k] * w[k];
  }
  return product;
}

}  // namespace fascia
