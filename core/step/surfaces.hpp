#pragma once

#include "core/physics/point_physics.hpp"
#include "core/space/array.hpp"
#include "core/space/row_sums.hpp"
#include "core/step/model_view.hpp"
#include "core/structure/surface_face.hpp"

#include <algorithm>
#include <span>
#include <vector>

namespace fascia {

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
  Vec3d *corner_area = nullptr, *corner_weight = nullptr;  ///< of the corners of faces; where none weighs no weight
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

/// A linearisation of surface loads: of each surface what products and matrices need, and of each enclosed volume with
/// a bulk modulus a term stiffness · g gᵀ.
template <class Space>
struct SurfaceTangent {
  bool curved = false;             ///< there is more than volumes
  Array<Space, Vec3d> x;           ///< of vertices, relative to the datum [m]
  Array<Space, double> pressure;   ///< at the datum of each surface [Pa]
  Array<Space, Vec3d> gradient;    ///< of its pressure [N/m³]
  Array<Space, double> stiffness;  ///< K / V* of each term [Pa/m³]
  /// dV by degrees of freedom (terms × degrees of freedom) [m²], [m³]. What acts on dependent nodes may be moved to
  /// their hosts in it.
  Array<Space, double> g;

  /// dV of one term.
  double* volume_gradient(int term) {
    return g.data() + static_cast<std::size_t>(term) * (g.size() / std::max<std::size_t>(stiffness.size(), 1));
  }
};

/// The surface loads of a model at a state. A pass over faces leaves something on their corners; vertices gather that,
/// and nodes from vertices.
///
/// Within Newton's method the geometric stiffness of an enclosed volume takes, in the place of p(V), the pressure that
/// the last linearised step led to: that of Newton's method for displacements and pressures together. A step leaves the
/// volume wrong to second order, and a large bulk modulus makes of that a pressure without meaning.
template <class Space>
class Surfaces {
 public:
  /// @param model  stays where it is
  explicit Surfaces(const Model& model, Space space = Space());

  bool empty() const { return view_.surfaces == 0; }
  std::span<const SurfaceLoad> loads() const { return loads_; }
  /// Every surface has a potential.
  bool conservative() const { return conservative_; }
  const SurfacesView& view() const { return view_; }

  /// Adds forces to the degrees of freedom. @param factors  of schedules, in the space, here and below
  void add_forces(const NodesView& nodes, const PoseView& pose, const double* factors, double* load);

  /// Figures that the last forces leave for the host: (surfaces × kSurfaceFigures) in the space.
  const double* figures() const { return figures_.data(); }
  std::size_t figure_count() const { return figures_.size(); }
  /// From figures that were copied: the potential of all surfaces [J], and what rounding leaves in the forces on a
  /// connected part [N].
  double potential(std::span<const double> figures) const;
  double rounding(int part, std::span<const double> figures) const;

  /// Takes the tangent at the last forces, and adds what the loads are on nodes alone: nothing but the volumes where
  /// the tangent leaves out the geometric stiffness.
  /// @param Q    I + D of each node, here and below
  /// @param out  keeps its memory from call to call
  void linearize(const NodesView& nodes, const Mat3d* Q, const double* factors, Tangent tangent,
                 SurfaceTangent<Space>& out, double* node_blocks);
  /// Volumes with a bulk modulus.
  int terms() const { return terms_; }
  /// y += K d, but for the volumes, or what the antisymmetric part of open surfaces makes of d.
  void add_product(const SurfaceTangent<Space>& tangent, const NodesView& nodes, const Mat3d* Q, const double* d,
                   double* y, TangentPart part = TangentPart::symmetric);
  /// y += Σ stiffness · g (g · d)
  void add_volume_product(const SurfaceTangent<Space>& tangent, const double* d, double* y);

  // Newton's pressures: from the last step's end on, towards what a direction leads to, back to those saved.
  void begin_step();
  /// @param direction  by degrees of freedom, the solution of a system with the linearisation
  void aim(const SurfaceTangent<Space>& tangent, const double* direction);
  void approach(double step);
  std::vector<double> followed() const { return newton_.downloaded(); }
  void follow(const std::vector<double>& pressures) { newton_.upload(pressures); }
  void save() { saved_.copy_from(newton_); }
  void restore() { newton_.copy_from(saved_); }
  void finish_step() { reached_.copy_from(newton_); }
  /// Newton's pressures at the end of the last step [Pa].
  std::vector<double> reached() const { return reached_.downloaded(); }
  /// @param reached  empty: none
  void begin_afresh(const std::vector<double>& reached) {
    reached_.set_zero();
    if (!reached.empty()) reached_.upload(reached);
  }

 private:
  void upload(const Model& model);
  void change_volumes(const SurfaceTangent<Space>& tangent, const double* d);

  Space space_;
  std::span<const SurfaceLoad> loads_;
  bool conservative_ = true, weighs_ = false;
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

  Array<Space, Vec3d> dx_, corner_pull_, pull_;  ///< of a product
  Array<Space, double> along_;                   ///< stiffness · (g · d) of each term

  bool stepping_ = false;
  Array<Space, double> newton_, aimed_, saved_, reached_;
};

}  // namespace fascia
