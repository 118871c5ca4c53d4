#pragma once

#include "core/linear/block_matrix.hpp"
#include "core/space/pool_space.hpp"
#include "core/step/surfaces.hpp"

#include <span>
#include <vector>

namespace fascia {

/// Adds to a matrix the symmetric part of the second derivative of what surface loads do, without the bulk modulus:
///
///   K_ij = −½ ∫ p ((N_i N_j,t − N_j N_i,t) [x,s]× − (N_i N_j,s − N_j N_i,s) [x,t]×) + N_i N_j (n gᵀ + g nᵀ) ds dt,
///
/// with n = x,s × x,t and g the gradient of p. Of a closed surface, or one whose free edges are held, that is all of
/// it; an open edge that moves has an antisymmetric part, which no matrix holds. Blocks of pairs of nodes that assembly
/// fills: a pattern made without the surface lacks some where nodes of a face share no point or element; these are left
/// out.
/// @param Q  I + D of each node
void add_blocks(std::span<const SurfaceLoad> loads, const SurfaceTangent<PoolSpace>& tangent,
                const std::vector<Mat3d>& Q, BlockMatrix& matrix);

}  // namespace fascia
