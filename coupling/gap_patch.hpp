#pragma once

#include "core/base/index.hpp"
#include "coupling/gap_sides.hpp"

/// The first side of a gap, joined to the second; for the files of gaps only.
namespace fascia::gap_parts {

/// Triangles of the first side, whose normals point out of the gap, and the nearest point of the second to each vertex.
struct GapPatch {
  std::vector<Vec3d> points, feet;
  std::vector<std::array<int, 3>> triangles;

  double gap(int point) const { return norm(feet[at(point)] - points[at(point)]); }
};

/// Cut finer than the first side where the second is curved: until edges are about as long as the second's, or no
/// longer than half the gap and their feet straight.
GapPatch gap_patch(const CheckedSides& sides);

/// Leaves out the triangles whose corners all touch, and those over which there is no space as they and their feet lie
/// in one plane. Returns their part of the area.
double drop_touching(GapPatch& patch, double tolerance);

/// Gives each fan of triangles around a vertex a vertex of its own, and cuts inner edges whose ends both touch at the
/// rim: then the space over the patch is a manifold also where bottom and top meet at the rim.
void separate(GapPatch& patch, const CheckedSides& sides);

/// Edges that one triangle has, as it runs through them.
std::vector<std::array<int, 2>> rim(const GapPatch& patch);

/// Volume between a triangle and its feet [m³], negative where the lines to the feet cross or leave the other way:
///   V = −∫₀¹ d · ½ e₁(s) × e₂(s) ds,   d the mean line, e(s) edges that go from those of the triangle to those of the
/// feet.
double prism_volume(const GapPatch& patch, std::size_t triangle);

}  // namespace fascia::gap_parts
