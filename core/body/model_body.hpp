#pragma once

#include "core/geometry/mesh.hpp"
#include "core/physics/point_law.hpp"
#include "core/structure/model.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace fascia {

/// Material of a point.
struct PointMaterialSpec : LawConstants {
  double mass_damping = 0, stiffness_damping = 0;  ///< [1/s], [s]
  Law law = Law::st_venant_kirchhoff;              ///< of solids
};

/// An integration point remembers this of stresses (core/physics/viscosity.hpp), for the stress at a place near it.
struct RememberedStress {
  Mat3d fading{};    ///< S_e there at the end of the last step [Pa]
  Mat3d left{};      ///< the sum of its branches [Pa]
  double share = 0;  ///< of S_e that they take at once [-]
  Mat3d active{};    ///< not remembered: what muscle makes by itself [Pa]

  /// The stress left at a place where S_e is another: the same part of the difference is left. Where S_e passes through
  /// zero at the point, that part says nothing: the correction is at most what is left there and what branches take of
  /// the difference at once.
  Mat3d at(const Mat3d& S_e) const;
};

/// Where a material point is attached: the nodes that move it.
struct Attachment {
  std::vector<int> nodes;  ///< of the model, ascending
  std::vector<Influence> influences;
  int cell = -1;  ///< of a frame grid, or the element
};

/// Displacement, rotation and displacement gradient of the field at an attachment.
struct FieldValue {
  Vec3d u{};
  Mat3d D{}, H{};  ///< blended rotation − I, F − I
};
FieldValue field_at(const Attachment& attachment, const State& state);

/// An integration point with what it weighs, for results.
struct BodyPoint : LawConstants {
  Vec3d X{};          ///< [m]
  double volume = 0;  ///< [m³]
  Vec3d middle{};     ///< its place on the middle of a sheet or line; X in a solid [m]
  Law law = Law::st_venant_kirchhoff;
  bool transverse = false;  ///< as in PointRule
  int axes = -1;            ///< of a thin law: index into ModelBody::axes()
  int cell = -1;            ///< of BodyCells
};

/// Strain (Green-Lagrange), stress (Cauchy) and energy density at a point.
struct PointTensors {
  Mat3d strain{}, stress{};   ///< [-], [Pa]
  double energy_density = 0;  ///< [J/m³]
};

/// Strain and stress of a body in one state, with the arguments of ModelBody::tensors_at.
using TensorField = std::function<PointTensors(const Attachment& place, std::size_t nearest)>;

/// A quadrature point of a face of the surface.
struct FacePoint {
  Vec3d X{};
  double area = 0;  ///< its part of the face [m²]
  Attachment attachment;
  std::vector<int> nodes;  ///< of the face, by points of the surface
};

/// A named set of a body's nodes and cells, from the groups of a mesh.
struct BodyGroup {
  std::string name;
  int number = 0, dimension = 0;
  std::vector<int> nodes, cells;  ///< of the body, ascending
};

/// A field of results that only some bodies have: values by node or by cell.
struct BodyField {
  std::string name;
  bool of_cells = false;
  int components = 1;
  std::vector<double> values;
};

/// Cells that a body carries: nodes of the body, corners first.
struct BodyCells {
  CellType type = CellType::tetrahedron;
  int nodes_per_cell = 4;
  std::vector<int> nodes;
};

class ThreadPool;

/// A body in a model. Its own nodes are a contiguous range, its groups of points and blocks of elements too; nodes of
/// other bodies may move it as well.
class ModelBody {
 public:
  virtual ~ModelBody() = default;

  int first_node() const { return first_node_; }
  int node_count() const { return node_count_; }
  /// Nodes of other bodies that are frames of this one too, ascending.
  const std::vector<int>& shared_nodes() const { return shared_; }
  const std::vector<BodyPoint>& points() const { return points_; }
  /// Rest axes of thin points: columns, tangents first.
  const std::vector<Mat3d>& axes() const { return axes_; }
  double volume() const { return volume_; }
  double mass() const { return mass_; }
  double size() const { return size_; }                     ///< diagonal of the bounding box [m]
  const TriangleMesh& surface() const { return surface_; }  ///< at rest; of a sheet its middle
  /// Pairs of points of the surface mesh that a line runs between.
  const std::vector<std::array<int, 2>>& segments() const { return segments_; }
  const std::vector<std::string>& messages() const { return messages_; }  ///< what a user should mind
  const std::vector<std::string>& choices() const { return choices_; }    ///< what was chosen for it, and why
  BodyBlocks blocks;  ///< in the model's point set; set by who closes the set
  /// Finds where a state has what its points remember of stresses. Once the set is closed and the blocks are known.
  void find_memories(const PointSet& set);
  const std::vector<BodyGroup>& groups() const { return groups_; }
  const BodyCells& cells() const { return cells_; }
  /// Weight of each node over its mass, where a static load of gravity is not shared as the mass is; else empty [kg].
  const std::vector<double>& weights() const { return weights_; }

  /// Name of the kind of body in a scene: "meshless", "tetrahedra", "hexahedra", "shell".
  virtual std::string model_name() const { return "meshless"; }
  /// λ is integrated at one point a cell.
  virtual bool selective() const { return false; }
  /// A node's weight is 1 at its own place: holding the nodes holds the material there.
  virtual bool interpolates() const { return true; }
  /// The nodes that move the material at a rest position.
  virtual Attachment attach(const Vec3d& X) const = 0;
  /// The nodes that move an integration point, exactly as the mechanics see it.
  virtual Attachment attach_point(std::size_t point) const = 0;
  /// The nodes that move the point whose volumetric strain stands for the cell of a place (selective integration).
  virtual Attachment attach_volumetric(const Attachment& at) const { return at; }
  /// The nodes that move a point of the surface.
  virtual Attachment attach_surface(std::size_t point) const { return attach(surface_.points[point]); }
  /// Faces of the surface by its points: corners counter-clockwise seen from outside, then the middle nodes of edges 01
  /// 12 .. of quadratic ones. Here its triangles.
  virtual std::vector<std::vector<int>> faces() const;
  /// Quadrature points of all faces: here three a triangle, exact for weights of degree two.
  virtual std::vector<FacePoint> face_points() const;
  /// ∂u/∂X at each integration point.
  virtual std::vector<Mat3d> gradients(const State& state) const;
  /// At each integration point, by one thread or by those of a pool.
  std::vector<PointTensors> tensors(const State& state) const;
  std::vector<PointTensors> tensors(const State& state, ThreadPool& pool) const;
  /// At any place. @param nearest  index of the integration point whose material counts there
  virtual PointTensors tensors_at(const Attachment& place, std::size_t nearest, const State& state) const;
  /// Tensors at many places of one state: what these share is computed once, when this is called. Body and state must
  /// outlive what it returns.
  virtual TensorField tensor_field(const State& state) const;
  /// Green-Lagrange strain at any place.
  virtual Mat3d strain_at(const Attachment& place, const State& state) const;
  /// Fields of results that only this kind of body has.
  virtual std::vector<BodyField> own_fields(const State& /*state*/) const { return {}; }
  /// Nodes on the outside: 1 (one entry a node of the body, then one for each of shared_nodes(), always 1).
  virtual std::vector<char> nodes_on_boundary() const = 0;
  /// Distance from X to the body [m]; 0 inside.
  virtual double distance(const Vec3d& X) const = 0;
  /// The mesh's own number of a cell. @param cell  BodyPoint::cell, at least 0
  virtual std::int64_t cell_number(int cell) const { return cell; }
  /// One line on how the weights do in this body; empty where there is nothing to say.
  virtual std::string quality() const { return ""; }

 protected:
  ModelBody() = default;
  /// tensors(), one for each of the points.
  virtual void store_tensors(const State& state, ThreadPool& pool, std::span<PointTensors> out) const;
  ModelBody(const ModelBody&) = default;
  ModelBody(ModelBody&&) = default;
  ModelBody& operator=(const ModelBody&) = default;
  ModelBody& operator=(ModelBody&&) = default;

  /// The stress that is left, and that muscle makes, adds to that of the law with lasting_constants().
  RememberedStress remembered(std::size_t point, const State& state) const;
  /// A triangle of a shell remembers strains: these are left in its branches, of its membrane (0 to 5)
  /// and bending (6 to 11).
  double remembered_strain(std::size_t triangle, int row, const State& state) const {
    const bool known = !memory_lane_.empty() && memory_lane_[triangle] != kNoLane;
    return known ? branch_sum(memory_lane_[triangle] + static_cast<std::size_t>(row / 6 * MemoryLayout::kLanes),
                              row % 6, state)
                 : 0;
  }
  /// This one is of its volumetric strain, where that is taken elsewhere (selective integration).
  RememberedStress remembered_volumetric(std::size_t point, const State& state) const {
    return remembered_at(volumetric_lane_, point, state);
  }

  double volume_ = 0, mass_ = 0, size_ = 0;
  int first_node_ = 0, node_count_ = 0;
  std::vector<int> shared_;
  std::vector<BodyPoint> points_;
  std::vector<Mat3d> axes_;
  TriangleMesh surface_;
  std::vector<std::array<int, 2>> segments_;
  std::vector<std::string> messages_, choices_;
  std::vector<BodyGroup> groups_;
  BodyCells cells_;
  std::vector<double> weights_;

 private:
  static constexpr std::size_t kNoLane = static_cast<std::size_t>(-1);
  double branch_sum(std::size_t lane, int row, const State& state) const;
  RememberedStress remembered_at(const std::vector<std::size_t>& lanes, std::size_t point, const State& state) const;
  void find_lanes_of_points(const PointSet& set);
  void find_lanes_of_elements(const PointSet& set);
  /// By points: their lanes, and those of their volumetric strain; empty where nothing fades.
  std::vector<std::size_t> memory_lane_, volumetric_lane_;
  std::size_t memory_stride_ = 0;  ///< numbers of a branch in a state
};

/// The constants with which a law gives the stress that never fades, and S_e, of which shares do.
LawConstants lasting_constants(LawConstants constants);
LawConstants relaxing_constants(LawConstants constants);
/// Poisson's ratio at once or in the long term, whichever is larger: elements and points lock by it.
double largest_poisson(const LawConstants& constants);

}  // namespace fascia
