#pragma once

#include "core/geometry/bounds.hpp"
#include "core/geometry/mesh.hpp"
#include "core/geometry/triangle_tree.hpp"

#include <span>

namespace fascia {

/// Which points lie in a closed surface, and how far from it.
///
/// A ray along +x meets the triangles whose projection on the (y, z) plane holds the point. Each edge is compared with
/// the point once and for all, from its lower to its higher vertex, so that its two triangles always agree: a ray
/// passes neither between two triangles nor through an edge twice, whatever the rounding.
class InsideTest {
 public:
  /// @param closed  outward-oriented; it is copied
  explicit InsideTest(const TriangleMesh& closed);

  /// Points of the surface itself, to rounding, count as either.
  bool contains(const Vec3d& x) const { return winding_number(x) > 0; }

  /// How often the surface surrounds the point: 1 inside of an outward surface, −1 inside of an inward one.
  int winding_number(const Vec3d& x) const;

  /// contains() for many points of a line along x: the triangles are looked through once.
  /// @param inside  receives 1 or 0 for each of x
  void contains_on_line(double y, double z, std::span<const double> x, std::span<char> inside) const;

  /// How long a line along x is inside, and how long it is surrounded otherwise than by the surface of a solid: twice,
  /// where parts overlap, or inside out; as often as it is too much.
  struct Surrounded {
    double inside = 0, wrong = 0;  ///< [m]
  };
  Surrounded surrounded(double y, double z) const;

  /// Distance to the surface [m], not signed; `nearest` receives the surface's nearest point.
  double distance(const Vec3d& x, Vec3d* nearest = nullptr) const { return tree_.distance(x, nearest); }

 private:
  int bin(int axis, double coordinate) const;
  std::size_t bin_number(int j, int k) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(bins_[1]) + static_cast<std::size_t>(k);
  }
  template <class Act>
  void for_each_bin(const std::array<int, 3>& triangle, Act&& act) const;
  void fill_bins();
  /// Where a triangle meets a line along x, and how often rays from smaller x pass it outwards.
  struct Crossing {
    double x;
    int passes;
  };
  template <class Act>
  void for_each_crossing(double y, double z, Act&& act) const;
  int passes(const std::array<int, 3>& triangle, double y, double z) const;
  double place_of_crossing(const std::array<int, 3>& triangle, double y, double z) const;

  TriangleMesh mesh_;
  TriangleTree tree_;
  Bounds bounds_;
  std::array<int, 2> bins_{1, 1};   ///< along y, z
  std::vector<std::size_t> begin_;  ///< of each bin in members_
  std::vector<int> members_;        ///< triangles by bin
};

}  // namespace fascia
