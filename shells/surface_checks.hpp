#pragma once

#include "shells/shell_mesh.hpp"

#include <string>
#include <vector>

/// What a shell's mesh is like: figures, holes, and what its element does badly on.
namespace fascia {

double area(const ShellMesh& mesh, std::size_t triangle);  ///< [m²]
double area(const ShellMesh& mesh);                        ///< [m²]
Vec3d middle(const ShellMesh& mesh, std::size_t triangle);

/// "triangle 12 of the file, at (1, 0, 2)", for messages; generated triangles are counted from 0.
std::string name_of(const ShellMesh& mesh, std::size_t triangle);

/// Shape of the triangles.
struct ShellQuality {
  double area = 0;          ///< of all [m²]
  double worst_aspect = 0;  ///< longest edge / height on it [-]: 1.15 equilateral, 2 half a square
  std::size_t worst = 0;    ///< the triangle that has it
  std::string sentence;     ///< counts, sizes and aspect in words
  /// Triangles of an aspect above 20, edges about which neighbours fold back, parts that share no node or single ones.
  std::vector<std::string> messages;
};
ShellQuality shell_quality(const ShellMesh& mesh);

/// Warnings where the thickness [m, one a triangle] does not fit the surface: above the radius of curvature, above the
/// length of the triangle's edges, or above half of the body's size.
///
/// The curvature of a triangle is the largest by amount of the tensor Σ ½ θ l e eᵀ / A over its edges: angle θ between
/// the normals, length l, direction e (Cohen-Steiner and Morvan, 2003, on one triangle). Edges where the normals turn
/// by 60° or more are creases of the shape, not its curvature.
std::vector<std::string> thickness_warnings(const ShellMesh& mesh, const std::vector<double>& thickness);

/// A loop of edges that one triangle has, or several loops that touch in a node.
struct ShellHole {
  std::vector<int> nodes;    ///< ascending
  std::size_t edges = 0;     ///< on the rim
  std::size_t triangle = 0;  ///< one at the rim
  Vec3d middle{};            ///< of the rim's edges [m]
  double length = 0;         ///< of the rim [m]
};

/// Empty where the surface is closed; otherwise by length, the longest rim first.
std::vector<ShellHole> holes(const ShellMesh& mesh);
inline bool closed(const ShellMesh& mesh) { return holes(mesh).empty(); }
/// "is open: ..." with number and places of the holes; empty where the surface is closed.
std::string openness(const ShellMesh& mesh);

/// How many parts share no node, and the nodes in which parts meet that share no edge there.
struct ShellParts {
  int count = 0;
  std::vector<int> pinched;  ///< ascending
};
ShellParts parts_of(const ShellMesh& mesh);

/// Volume that a closed surface encloses [m³].
double enclosed_volume(const ShellMesh& mesh);

}  // namespace fascia
