#pragma once

#include "coupling/gap_patch.hpp"

namespace fascia::gap_parts {

/// The closed surface of the space over a patch: the patch, walls along its rim, and its feet. Where the gap closes at
/// the rim, bottom and top share their points; feet that coincide along an edge are one, and triangles without area
/// are gone as far as their neighbours allow.
TriangleMesh surface_over(const GapPatch& patch, const CheckedSides& sides);

}  // namespace fascia::gap_parts
