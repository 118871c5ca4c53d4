#pragma once

#include "core/geometry/triangle_tree.hpp"
#include "coupling/gap.hpp"

/// Both sides of a gap after all checks; for the files of gaps only.
namespace fascia::gap_parts {

struct CheckedSides {
  TriangleMesh first, second;  ///< the selected faces on the points that they use
  TriangleTree to_second;      ///< nearest points of the second
  std::string first_body, second_body;
  double size = 0;      ///< the larger of the sides' diagonals [m]
  double touching = 0;  ///< points of the sides that are nearer to each other touch [m]
};

/// @throws InputError  a side without faces, bodies that overlap, sides that do not face each other
CheckedSides checked_sides(const GapSide& first, const GapSide& second);

/// Mean length of the triangles' edges [m].
double mean_edge(const TriangleMesh& mesh);

/// Twice a triangle's area, along its normal [m²].
Vec3d double_area(const TriangleMesh& mesh, std::size_t triangle);

[[noreturn]] void fail_facing(const std::string& first_body, const std::string& second_body);
/// The sides touch wherever they face each other.
[[noreturn]] void fail_touching(const std::string& first_body, const std::string& second_body);

}  // namespace fascia::gap_parts
