#pragma once

#include "core/math/mat3.hpp"
#include "core/structure/face_rule.hpp"

#include <span>
#include <vector>

namespace fascia {

struct State;

/// How a node moves a vertex of a surface: w u + D b.
struct SurfaceShare {
  int node = 0;
  double w = 0;
  Vec3d b{};
};

/// Pressure on a surface that moves, along the present normal of its faces (positive along it) [Pa]:
///
///   p(x) = s P + K (V* − V) / V* + s_g ρ g · (x − datum),   V* = V₀ + s (V₁ − V₀),
///
/// with s the factor of its schedule, s_g that of gravity, and V the volume that a closed surface encloses. Such a
/// surface has the potential
///
///   −s P V + ½ K (V − V*)² / V* − s_g ρ ∫ g · (x − datum) dV,
///
/// whose exact gradient the forces on the vertices are, f_i = ∫ p N_i n dA. What fills the surface has no inertia.
struct SurfaceLoad {
  std::vector<Vec3d> X;             ///< vertices at rest [m]
  std::vector<int> share_begin{0};  ///< (vertices + 1)
  std::vector<SurfaceShare> shares;
  std::vector<int> face_begin{0};  ///< (faces + 1)
  std::vector<int> face_vertex;    ///< by face, as face_rule() orders them
  bool closed = false;             ///< every edge joins two faces; needed by all but P
  bool has_potential = false;      ///< closed, or all that moves its free edges is held

  int schedule = 0;
  double pressure = 0;                 ///< P [Pa]
  double bulk_modulus = 0;             ///< K [Pa]
  double rest_volume = 0, volume = 0;  ///< V₀, V₁ of a closed surface [m³]
  int weight_schedule = 0;
  Vec3d weight{};  ///< ρ g [N/m³]
  Vec3d datum{};   ///< fixed in space [m]

  int vertex_count() const { return static_cast<int>(X.size()); }
  int face_count() const { return static_cast<int>(face_begin.size()) - 1; }
  std::span<const int> face(int f) const;
  std::span<const SurfaceShare> shares_of(int vertex) const;
};

/// Adds a vertex that one node is, or several nodes move. @return its number
int add_vertex(SurfaceLoad& load, const Vec3d& X, std::span<const SurfaceShare> shares);
void add_face(SurfaceLoad& load, std::span<const int> vertices);

/// Sets V₀ and V₁ to the volume at rest, and the datum to the centre of it; of an open surface the mean of its
/// vertices.
void measure_at_rest(SurfaceLoad& load);

/// A surface load at a state. What it needs is allocated at the first use.
struct SurfaceForces {
  std::vector<Vec3d> u, x;   ///< of the vertices: displacement; place relative to the datum [m]
  std::vector<Vec3d> force;  ///< [N]
  std::vector<Vec3d> area;   ///< ∫ N n dA = dV/dx [m²]
  double volume = 0;         ///< of a closed surface [m³]
  double pressure = 0;       ///< at the datum [Pa]
  double energy = 0;         ///< where there is a potential, up to a constant [J]
  double rounding = 0;       ///< what rounding leaves in all forces together [N]
  double stiffness = 0;      ///< K / V* [Pa/m³]
};
void evaluate(const SurfaceLoad& load, const State& state, std::span<const double> factors, SurfaceForces& out);

}  // namespace fascia
