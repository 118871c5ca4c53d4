#pragma once

#include "core/physics/point_physics.hpp"
#include "core/space/array.hpp"
#include "core/space/row_sums.hpp"
#include "core/structure/model.hpp"
#include "core/structure/surface_face.hpp"
#include "gpu/space/views.hpp"

#include <span>
#include <vector>

namespace fascia::gpu {

/// Constants of a surface load beside its faces.
struct SurfaceRule {
  int schedule = 0, weight_schedule = 0;
  bool has_potential = false;
  double pressure = 0, bulk_modulus = 0, rest_volume = 0, volume = 0;
  Vec3d weight{};
};

/// Figures of each surface at the last forces, as in SurfaceForces.
enum SurfaceFigure { kVolumeInside, kPressure, kPotential, kPressureRounding, kStiffness, kSurfaceFigures };

/// The vertices, faces and shares of all surfaces, one after the other.
struct SurfacesView {
  int vertices = 0, faces = 0, surfaces = 0;
  const SurfaceRule* rule = nullptr;
  const int *vertex_surface = nullptr, *face_surface = nullptr;
  const Vec3d *X = nullptr, *datum = nullptr;  ///< of vertices; of surfaces
  const int* share_begin = nullptr;            ///< (vertices + 1)
  const SurfaceShare* share = nullptr;
  const int* share_vertex = nullptr;
  const int *face_begin = nullptr, *face_vertex = nullptr;
  const FaceRulePoint* points = nullptr;  ///< of faces with 3, 4, 6 and 8 nodes
  int points_begin[5] = {};

  // At the last forces.
  Vec3d *u = nullptr, *x = nullptr;                        ///< of vertices; x relative to the datum
  Vec3d *corner_area = nullptr, *corner_weight = nullptr;  ///< of the corners of faces
  double* face_sums = nullptr;               ///< (faces × 3): change of volume, size of its terms, ∫ w · x dV
  Vec3d *area = nullptr, *weight = nullptr;  ///< of vertices: ∫ N n dA, force of the weight
  double* surface_sums = nullptr;            ///< (surfaces × 3)
  double* figures = nullptr;                 ///< (surfaces × kSurfaceFigures)

  FASCIA_HD SurfaceFace face(int f) const {
    const int n = face_begin[f + 1] - face_begin[f], k = n == 3 ? 0 : n == 4 ? 1 : n == 6 ? 2 : 3;
    return {face_vertex + face_begin[f], n, points + points_begin[k], points_begin[k + 1] - points_begin[k]};
  }
  FASCIA_HD double figure(int surface, SurfaceFigure which) const { return figures[surface * kSurfaceFigures + which]; }
  FASCIA_HD Vec3d force(int vertex, double pressure) const { return area[vertex] * pressure + weight[vertex]; }
};

/// Data of the surfaces that products need, as SurfaceTangent and RankOne.
struct SurfaceTangentView {
  const Vec3d* x = nullptr;
  double* pressure = nullptr;  ///< of each surface
  Vec3d* gradient = nullptr;
  double *stiffness = nullptr, *along = nullptr;  ///< of each term: K / V*, and that times the change of volume
  double* g = nullptr;                            ///< (terms × degrees of freedom)
};

/// The surface loads of a model on the device, as SurfaceLoads (core/solver/surface_loads.hpp), which says what
/// Newton's pressures are. A pass over faces leaves something on their corners; vertices gather that, and nodes from
/// vertices.
template <class Space>
class Surfaces {
 public:
  explicit Surfaces(const Model& model);

  bool empty() const { return view_.surfaces == 0; }

  /// Adds forces to the degrees of freedom. @param factors  of schedules, in the space, here and below
  void add_forces(const NodesView& nodes, const PoseView& pose, const double* factors, double* load);

  /// Figures that the last forces leave for the host: (surfaces × kSurfaceFigures) in the space.
  const double* figures() const { return figures_.data(); }
  std::size_t figure_count() const { return figures_.size(); }
  /// From figures that were copied: the potential of all surfaces [J], and what rounding leaves in the forces on a
  /// connected part [N].
  double potential(std::span<const double> figures) const;
  double rounding(int part, std::span<const double> figures) const;

  /// Takes the tangent at the last forces, and adds what the loads are on nodes alone.
  /// @param Q  I + D of each node, here and below
  void linearize(const NodesView& nodes, const Mat3d* Q, const double* factors, Tangent tangent, double* node_blocks);
  /// Volumes with a bulk modulus, each of which is stiffness · g gᵀ in the tangent.
  int terms() const { return terms_; }
  /// dV of the linearisation by degrees of freedom. What acts on dependent nodes may be moved to their hosts in it.
  double* volume_gradient(int term) { return gradients_.data() + static_cast<std::size_t>(term) * dofs_; }
  /// y += K x, but for the volumes.
  void add_product(const NodesView& nodes, const Mat3d* Q, const DirectionView& direction, double* y);
  /// y += Σ stiffness · g (g · d)
  void add_volume_product(const double* d, double* y);

  // Newton's pressures.
  void begin_step();
  /// @param direction  by degrees of freedom, the solution of a system with the linearisation
  void aim(const double* direction);
  void approach(double step);
  std::vector<double> followed() const { return newton_.downloaded(); }
  void save() { saved_.copy_from(newton_); }
  void restore() { newton_.copy_from(saved_); }
  void finish_step() { reached_.copy_from(newton_); }
  std::vector<double> reached() const { return reached_.downloaded(); }
  /// @param reached  empty: none
  void begin_afresh(const std::vector<double>& reached) {
    reached_.set_zero();
    if (!reached.empty()) reached_.upload(reached);
  }

 private:
  void upload(const Model& model);
  void change_volumes(const double* d);

  std::size_t dofs_ = 0;
  int terms_ = 0;
  std::vector<int> part_;                                        ///< connected part of each surface
  RowSums<Space> by_vertex_, by_surface_, vertices_by_surface_;  ///< corners, faces, vertices
  RowSums<Space> by_node_, by_term_node_;                        ///< shares
  Array<Space, SurfaceRule> rule_;
  Array<Space, int> vertex_surface_, face_surface_, share_begin_, share_vertex_, face_begin_, face_vertex_;
  Array<Space, int> loaded_;               ///< nodes that have shares
  Array<Space, int> row_term_, row_node_;  ///< of the rows of by_term_node_
  Array<Space, int> term_surface_;
  Array<Space, Vec3d> X_, datum_, u_, x_, corner_area_, corner_weight_, area_, weight_;
  Array<Space, SurfaceShare> share_;
  Array<Space, FaceRulePoint> points_;
  Array<Space, double> face_sums_, surface_sums_, figures_;
  SurfacesView view_;

  bool curved_ = false;  ///< the linearisation has more than volumes
  Array<Space, Vec3d> linear_x_, gradient_, dx_, corner_pull_, pull_;
  Array<Space, double> pressure_, stiffness_, along_, gradients_;
  SurfaceTangentView tangent_;

  bool stepping_ = false;
  Array<Space, double> newton_, aimed_, saved_, reached_;
};

}  // namespace fascia::gpu
