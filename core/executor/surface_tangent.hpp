#pragma once

#include "core/linear/block_matrix.hpp"
#include "core/structure/dof_layout.hpp"
#include "core/structure/surface_face.hpp"
#include "core/structure/surface_load.hpp"

#include <span>
#include <vector>

namespace fascia {

/// The symmetric part of the second derivative of what a surface load does, at a state, without the bulk modulus:
///
///   K_ij = −½ ∫ p ((N_i N_j,t − N_j N_i,t) [x,s]× − (N_i N_j,s − N_j N_i,s) [x,t]×) + N_i N_j (n gᵀ + g nᵀ) ds dt,
///
/// with n = x,s × x,t and g the gradient of p. Of a closed surface, or one whose free edges are held, that is all of
/// it; an open edge that moves has an antisymmetric part, which no matrix holds.
struct SurfaceTangent {
  const SurfaceLoad* load = nullptr;
  std::vector<Vec3d> x;  ///< SurfaceForces::x
  double pressure = 0;   ///< at the datum [Pa]
  Vec3d gradient{};      ///< of the pressure [N/m³]
};

/// stiffness · g gᵀ beside a matrix: the volume of a fluid joins all nodes of its surface.
struct RankOne {
  double stiffness = 0;   ///< K / V* [Pa/m³]
  std::vector<double> g;  ///< dV by degrees of freedom [m²], [m³]
};

/// Adds what forces on the vertices are on the nodes' degrees of freedom.
void gather_forces(const SurfaceLoad& load, const std::vector<Vec3d>& force, const State& state, const DofLayout& dofs,
                   std::span<double> out);

/// y += K x, or what the antisymmetric part makes of x. @param Q  I + D of each node
void add_product(const SurfaceTangent& tangent, const DofLayout& dofs, const std::vector<Mat3d>& Q,
                 std::span<const double> x, std::span<double> y, TangentPart part = TangentPart::symmetric);
void add_product(const RankOne& update, std::span<const double> x, std::span<double> y);

/// Adds the blocks of pairs of nodes that assembly fills. A pattern made without the surface lacks some where nodes of
/// a face share no point or element; these are left out.
void add_blocks(const SurfaceTangent& tangent, const std::vector<Mat3d>& Q, BlockMatrix& matrix);

}  // namespace fascia
