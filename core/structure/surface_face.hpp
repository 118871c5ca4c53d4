#pragma once

#include "core/base/index.hpp"
#include "core/structure/dof_layout.hpp"
#include "core/structure/surface_load.hpp"

#include <array>
#include <cmath>
#include <limits>

/// A surface load at one face, and at one vertex that nodes move, as functions of plain values. The formulas are those
/// of surface_load.hpp and surface_tangent.hpp.
namespace fascia {

/// A face: its vertices, and the points of its quadrature (face_rule() of as many nodes).
struct SurfaceFace {
  const int* vertex = nullptr;
  int nodes = 0;
  const FaceRulePoint* rule = nullptr;
  int points = 0;

  static SurfaceFace of(const SurfaceLoad& load, int face) {
    const std::span<const int> vertices = load.face(face);
    const int n = static_cast<int>(vertices.size());
    const std::span<const FaceRulePoint> rule = face_rule(n);
    return {vertices.data(), n, rule.data(), static_cast<int>(rule.size())};
  }
};

/// Σ N x and its derivatives along s and t.
struct FacePlace {
  Vec3d x{}, s{}, t{};

  FASCIA_HD FacePlace(const FaceRulePoint& p, const SurfaceFace& face, const Vec3d* vertices) {
    for (int a = 0; a < face.nodes; ++a) {
      const Vec3d& v = vertices[face.vertex[a]];
      x += v * p.N[at(a)];
      s += v * p.ds[at(a)];
      t += v * p.dt[at(a)];
    }
  }
};

FASCIA_HD inline double triple(const Vec3d& a, const Vec3d& b, const Vec3d& c) { return dot(a, cross(b, c)); }

/// Calls add(a, ∫ N_a n dA) for the corners, term by term. @param x  present places
template <class Add>
FASCIA_HD void add_face_area(const SurfaceFace& face, const Vec3d* x, const Add& add) {
  for (int k = 0; k < face.points; ++k) {
    const FaceRulePoint& p = face.rule[k];
    const FacePlace now(p, face, x);
    const Vec3d normal = cross(now.s, now.t) * p.weight;
    for (int a = 0; a < face.nodes; ++a) add(a, normal * p.N[at(a)]);
  }
}

/// Adds what a face adds to volume − volume at rest, as a sum of terms with the displacement in each.
/// @param X, u, x  of the vertices: at rest, displacements, present places
/// @param sizes    of the terms [m³]
FASCIA_HD inline void add_face_volume(const SurfaceFace& face, const Vec3d* X, const Vec3d* u, const Vec3d* x,
                                      double& change, double& sizes) {
  for (int k = 0; k < face.points; ++k) {
    const FaceRulePoint& p = face.rule[k];
    const FacePlace rest(p, face, X), moved(p, face, u), now(p, face, x);
    const double terms[3] = {triple(moved.x, rest.s, rest.t), triple(now.x, moved.s, rest.t),
                             triple(now.x, now.s, moved.t)};
    for (const double term : terms) {
      change += p.weight / 3 * term;
      sizes += p.weight / 3 * std::abs(term);
    }
  }
}

/// Calls add(a, force) for the corners, term by term, with the forces of a pressure w · x; adds ∫ w · x dV to `moment`.
template <class Add>
FASCIA_HD void add_face_weight(const SurfaceFace& face, const Vec3d* x, const Vec3d& w, double& moment,
                               const Add& add) {
  for (int k = 0; k < face.points; ++k) {
    const FaceRulePoint& p = face.rule[k];
    const FacePlace now(p, face, x);
    const Vec3d n = cross(now.s, now.t) * p.weight;
    const double pressure = dot(w, now.x);
    for (int a = 0; a < face.nodes; ++a) add(a, n * (pressure * p.N[at(a)]));
    moment += 0.25 * pressure * dot(now.x, n);  // div(x (w · x)) = 4 w · x
  }
}

using FaceBlocks = std::array<std::array<Mat3d, kMostFaceNodes>, kMostFaceNodes>;

/// K_ij of a face. The terms with p are antisymmetric matrices, and antisymmetric in i and j.
/// @param x         places relative to the datum, where the pressure is `pressure` [m]
/// @param gradient  of the pressure [N/m³]
FASCIA_HD inline void face_blocks(const SurfaceFace& face, const Vec3d* x, double pressure, const Vec3d& gradient,
                                  FaceBlocks& K) {
  const std::size_t n = at(face.nodes);
  const bool weighs = squared_norm(gradient) > 0;
  std::array<std::array<Vec3d, kMostFaceNodes>, kMostFaceNodes> axis;  // of K_ij, j < i
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      axis[i][j] = {};
      K[i][j] = {};
    }
  for (int k = 0; k < face.points; ++k) {
    const FaceRulePoint& q = face.rule[k];
    const FacePlace now(q, face, x);
    const double half = -0.5 * q.weight, p = half * (pressure + dot(gradient, now.x));
    const Vec3d ps = now.s * p, pt = now.t * p;
    for (std::size_t i = 1; i < n; ++i)
      for (std::size_t j = 0; j < i; ++j)
        axis[i][j] += ps * (q.N[i] * q.dt[j] - q.N[j] * q.dt[i]) - pt * (q.N[i] * q.ds[j] - q.N[j] * q.ds[i]);
    if (!weighs) continue;
    const Vec3d normal = cross(now.s, now.t);
    const Mat3d slope = (outer(normal, gradient) + outer(gradient, normal)) * half;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) K[i][j] += slope * (q.N[i] * q.N[j]);
  }
  for (std::size_t i = 1; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Mat3d turn = skew(axis[i][j]);
      K[i][j] += turn;
      K[j][i] -= turn;
    }
}

/// Half the sum of a derivative and its transpose, or half their difference; their sum is the derivative.
enum class TangentPart { symmetric, antisymmetric };

/// Calls add(i, Σ_j K_ij dx_j) for the corners, term by term. @param dx  of the vertices, the rest as above
template <class Add>
FASCIA_HD void add_face_product(const SurfaceFace& face, const Vec3d* x, double pressure, const Vec3d& gradient,
                                const Vec3d* dx, TangentPart part, const Add& add) {
  const double transposed = part == TangentPart::symmetric ? 1 : -1;
  for (int k = 0; k < face.points; ++k) {
    const FaceRulePoint& q = face.rule[k];
    const FacePlace now(q, face, x), moved(q, face, dx);
    const double half = -0.5 * q.weight, p = half * (pressure + dot(gradient, now.x));
    const Vec3d ps = now.s * p, pt = now.t * p, normal = cross(now.s, now.t);
    const Vec3d slope = (normal * dot(gradient, moved.x) + gradient * (transposed * dot(normal, moved.x))) * half;
    const Vec3d along = cross(ps, moved.t) - cross(pt, moved.s) + slope;
    const Vec3d by_s = cross(pt, moved.x) * transposed, by_t = cross(ps, moved.x) * transposed;
    for (int i = 0; i < face.nodes; ++i) add(i, along * q.N[at(i)] + by_s * q.ds[at(i)] - by_t * q.dt[at(i)]);
  }
}

/// Displacement that a share of a node adds to a vertex. @param u, D  of the node
FASCIA_HD inline Vec3d share_displacement(const SurfaceShare& share, const Vec3d& u, const Mat3d& D) {
  return u * share.w + D * share.b;
}

/// Displacement that a share adds to a vertex for increments d of its node by degrees of freedom. @param Q  the node's
/// present I + D
FASCIA_HD inline Vec3d share_variation(const SurfaceShare& share, FrameKind kind, const double* d, const Mat3d& Q) {
  return Vec3d{{d[0], d[1], d[2]}} * share.w + frame_variation(kind, d + 3, Q) * share.b;
}

/// Adds what a force on a vertex is on the degrees of freedom of a node that moves it.
FASCIA_HD inline void add_share_force(const SurfaceShare& share, FrameKind kind, const Vec3d& force, const Mat3d& Q,
                                      double* g) {
  for (int k = 0; k < 3; ++k) g[k] += share.w * force[k];
  add_moment(kind, outer(force, share.b), Q, g + 3);
}

/// How the degrees of freedom of a node move a vertex: column by column.
using ShareColumns = std::array<Vec3d, kMostDofs>;
FASCIA_HD inline ShareColumns share_columns(const SurfaceShare& share, FrameKind kind, const Mat3d& Q) {
  ShareColumns J{};
  for (int k = 0; k < 3; ++k) J[at(k)][k] = share.w;
  for (int k = 0; k < dof_count(kind) - 3; ++k) {
    double unit[kMostDofs - 3] = {};
    unit[k] = 1;
    J[at(3 + k)] = frame_variation(kind, unit, Q) * share.b;
  }
  return J;
}

/// Volume, pressure and energy of what fills a closed surface, or presses on one with a potential, for a change of its
/// volume.
struct SurfacePressure {
  double volume = 0;     ///< [m³]
  double pressure = 0;   ///< at the datum [Pa]
  double energy = 0;     ///< [J]
  double stiffness = 0;  ///< K / V* [Pa/m³]
  double rounding = 0;   ///< what rounding leaves in the pressure [Pa]
};

/// @param pressure, bulk_modulus, rest_volume, volume  P, K, V₀ and V₁ of the load
/// @param s       factor of its schedule
/// @param change  of the volume since rest, sizes of the terms that it is a sum of [m³]
FASCIA_HD inline SurfacePressure surface_pressure(double pressure, double bulk_modulus, double rest_volume,
                                                  double volume, double s, double change, double sizes) {
  constexpr double kEps = std::numeric_limits<double>::epsilon();
  SurfacePressure out;
  const double wanted = s * (volume - rest_volume);
  out.volume = rest_volume + change;
  out.pressure = s * pressure;
  out.energy = -out.pressure * change;
  if (!(bulk_modulus > 0)) return out;
  out.stiffness = bulk_modulus / (rest_volume + wanted);
  out.pressure += out.stiffness * (wanted - change);
  out.energy += 0.5 * out.stiffness * (change - wanted) * (change - wanted);
  out.rounding = kEps * out.stiffness * (sizes + std::abs(wanted));
  return out;
}

}  // namespace fascia
