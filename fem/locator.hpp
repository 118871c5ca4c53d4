#pragma once

#include "core/geometry/bounds.hpp"
#include "core/geometry/triangle_tree.hpp"
#include "fem/element_mesh.hpp"

namespace fascia {

/// A place in a mesh of elements.
struct Located {
  int element = -1;     ///< −1 where the mesh has none
  Vec3d xi{};           ///< in the reference element
  double distance = 0;  ///< from the point that was asked for; 0 inside [m]
};

/// The place of an element that is nearest to a point: its reference coordinates and its distance.
///
/// Tetrahedra with straight edges are exact. Elsewhere the distance is minimised over the reference element from its
/// middle, by Gauss-Newton steps that are bound to it; of several minima of a strongly curved element it may miss the
/// lowest.
Located nearest_in_element(const ElementMesh& mesh, std::size_t element, const Vec3d& X);

/// Finds the element that holds a point: bounding boxes of elements in a uniform grid.
class ElementLocator {
 public:
  /// @param mesh  it is copied
  explicit ElementLocator(ElementMesh mesh);

  /// The element that holds X, of several the one of the lowest index; where none does, the nearest place on the
  /// boundary (among the elements around the nearest place of its triangles, see BoundaryFaces). Places up to 1e-10 of
  /// an element's size beyond it count as inside.
  Located locate(const Vec3d& X) const;

  const ElementMesh& mesh() const { return mesh_; }

 private:
  Bounds box_of(std::size_t element) const;
  void size_grid();
  void fill_cells();
  int cell_along(int axis, double coordinate) const;
  std::size_t cell_at(const Vec3d& X) const;
  template <class Act>
  void for_each_cell(const Bounds& box, Act&& act) const;
  /// Elements whose boxes hold X, ascending: act(element) returns whether to stop.
  template <class Act>
  void for_each_near(const Vec3d& X, Act&& act) const;

  ElementMesh mesh_;
  TriangleTree boundary_;
  std::vector<Bounds> boxes_;
  Bounds whole_;
  std::array<int, 3> cells_{1, 1, 1};
  std::vector<std::size_t> begin_;  ///< of each cell in members_
  std::vector<int> members_;        ///< elements by cell
};

}  // namespace fascia
