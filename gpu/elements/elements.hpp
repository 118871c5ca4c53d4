#pragma once

#include "core/physics/point_physics.hpp"
#include "core/solver/settings.hpp"
#include "core/space/array.hpp"
#include "core/structure/point_set.hpp"
#include "gpu/space/views.hpp"

#include <type_traits>
#include <utility>
#include <vector>

namespace fascia::gpu {

/// One block of elements, in the layout of core/structure/element_block.hpp, with constants and what passes leave of a
/// scalar T. An element of several points passes what it has at them through `points_buffer`; a linear tetrahedron
/// keeps it in registers.
template <class T>
struct ElementBlockOf {
  Law law = Law::linear;
  bool averaged = false, penalised = false, damped = false;
  int nodes = 4, points = 1, count = 0, batches = 0;
  const T *gradient = nullptr, *volume = nullptr, *material = nullptr;
  const double* squared_gradient = nullptr;  ///< (batches × points × 8): Σ |g|² over the nodes [1/m²]
  const int* node = nullptr;                 ///< (batches × nodes × 8), of the model

  T* corners = nullptr;          ///< (batches × nodes × 3 × 8): force of the last pass on each node
  T* points_buffer = nullptr;    ///< (batches × points × 9 × 8): H or dH, then v P or v dP
  double* quantities = nullptr;  ///< (batches × 8 × kQuantities)

  // Of the linearisation. The rotation's third column follows from the others.
  T* H = nullptr;         ///< (batches × points × 9 × 8), of several points
  T* turn = nullptr;      ///< (batches × 6 × 8): first columns of R − I, co-rotational
  T* pressure = nullptr;  ///< (batches × 8): mean of λ θ about the nodes, averaged [Pa]

  // Averages about nodes (core/executor/element_average.cpp).
  const int *around_begin = nullptr, *around = nullptr;     ///< 4 · element + corner about each node, ascending
  const T *node_volume = nullptr, *node_modulus = nullptr;  ///< Σ V/4 [m³], mean k [Pa]
  T *theta = nullptr, *node_pressure = nullptr;             ///< V θ/4 of elements, λ times the nodes' mean of θ

  FASCIA_HD bool one_point() const { return nodes == 4; }
  FASCIA_HD int lanes() const { return batches * kElementLanes; }
};

using ElementBlockView = ElementBlockOf<double>;

/// Forces that all elements gave the nodes of a model.
template <class T>
struct ElementsOf {
  const int *node_begin = nullptr, *node_corner = nullptr;  ///< place of each corner's force, ascending
  const T* corners = nullptr;

  /// Adds what the last pass gave a node.
  FASCIA_HD void add_sums(int node, NodeSums& sums) const {
    for (int k = node_begin[node]; k < node_begin[node + 1]; ++k) {
      const T* force = corners + node_corner[k];
      for (int i = 0; i < 3; ++i) sums.force[i] += force[i * kElementLanes];
    }
  }
};

using ElementsView = ElementsOf<double>;

/// The finite elements of a model on the device: forces on the corners of elements, which nodes then gather.
template <class Space>
class Elements {
 public:
  explicit Elements(const PointSet& set, Precision precision = Precision::full);

  bool empty() const { return blocks_.empty(); }
  const ElementsView& view() const { return view_of<double>(); }
  /// After a product: with the scalar of products.
  template <class T>
  const ElementsOf<T>& view_of() const {
    if constexpr (std::is_same_v<T, double>)
      return view_;
    else
      return narrow_view_;
  }
  /// (blocks: batches × points × 6 × 8), as ElementExecutor has them
  std::size_t strain_size() const { return strain_size_; }

  /// Connected part of each item of quantities(), −1 in unused lanes: one item a lane.
  std::vector<int> item_parts(const PointSet& set) const;
  /// (items × kQuantities), of the last forces with them
  const double* quantities() const { return quantities_.data(); }

  /// The gradient of the energy at a pose, for add_sums(). @param part_motion  largest motion of each part (parts) [m];
  /// quantities only where it is given
  void forces(const NodesView& nodes, const PoseView& pose, const HistoryView& history, const double* part_motion);
  /// Keeps what products need of a pose.
  void linearize(const PoseView& pose, const HistoryView& history, Tangent tangent, const TakenStepView& taken = {});
  /// The last linearisation has extrapolated stresses: its products are other loops.
  bool extrapolated() const { return extrapolated_; }
  /// The largest rotation that a motion has in elements, to first order, into *out [rad].
  void largest_spin(const Vec3d* dx, double* out) const;
  /// The tangent's product at the linearisation, for add_sums() of view_of<T>(). @tparam T  of the precision
  template <class T, class V>
  void product(const DirectionOf<T, V>& direction);
  /// Adds the tangent's own block of each node, by rows; what add_sums() gives is lost.
  void add_diagonal(const NodesView& nodes, const Mat3d* Q, double* blocks);
  /// @param E  (strain_size())
  void store_strain(const PoseView& pose, double* E);
  void store_stress(const PoseView& pose, const double* given, double* out);

 private:
  /// Arrays of a block that have a scalar T. Of 32 bits, they are there for products beside those for forces.
  template <class T>
  struct Rows {
    Array<Space, T> gradient, volume, material, points_buffer, H, turn, pressure;
    Array<Space, T> node_volume, node_modulus, theta, node_pressure;
    ElementBlockOf<T> view;
  };
  struct Block {
    Array<Space, double> squared_gradient;
    Array<Space, int> node, around_begin, around;
    Rows<double> wide;
    Rows<float> narrow;
    std::size_t strain_begin = 0;
    std::size_t memory_begin = 0;  ///< first of its lanes
    bool remembers = false;
    bool extrapolates = false;  ///< ElementBlock::extrapolates()

    const ElementBlockView& view() const { return wide.view; }
    template <class T>
    const ElementBlockOf<T>& view_of() const {
      if constexpr (std::is_same_v<T, double>)
        return wide.view;
      else
        return narrow.view;
    }
  };
  static Block make_block(const ElementBlock& block, int nodes_of_model, bool narrow);
  template <class T>
  static void fill_rows(const ElementBlock& block, bool products, const Block& out, Rows<T>& rows);
  static void prepare_average(const ElementBlock& block, int nodes_of_model, bool narrow, Block& out);
  template <class T>
  void place_corners(Array<Space, T>& corners, std::size_t size, Rows<T> Block::*rows);
  void find_corners(const PointSet& set);
  /// Finds that of one block. @param all  of all: strains of elements, what is given of all blocks
  static HistoryView history_of(const Block& block, const HistoryView& all);
  HistoryView kept_history(const Block& block) const {
    HistoryView kept = history_of(block, linearized_history());
    if (block.extrapolates && extrapolated_) kept.S = S_.data() + block.strain_begin;
    return kept;
  }
  template <class T>
  void linearize_as();
  void extrapolate(const TakenStepView& taken);
  template <class T>
  void add_diagonal_as(const NodesView& nodes, double* blocks);
  /// Averages θ, or its derivative along dx, into node_pressure.
  template <class T, class V>
  void average(const ElementBlockOf<T>& view, const HistoryView& history, const Vec3d* u, const Vec3<V>* dx);
  HistoryView linearized_history() const {
    return {.E = E_.empty() ? nullptr : E_.data(), .inverse_step = inverse_step_, .given = given_};
  }

  std::vector<Block> blocks_;
  Array<Space, int> node_begin_, node_corner_;
  Array<Space, double> corners_, quantities_;
  Array<Space, float> narrow_corners_;
  ElementsView view_;
  ElementsOf<float> narrow_view_;
  int nodes_ = 0;
  bool is_narrow_;  ///< products have 32 bits
  std::size_t strain_size_ = 0;

  // Of the linearisation.
  Array<Space, Vec3d> u_;
  Array<Space, double> E_, S_;  ///< S: extrapolated stresses
  bool extrapolated_ = false;   ///< the linearisation has them
  double inverse_step_ = 0;
  const double* given_ = nullptr;
  Tangent tangent_ = Tangent::full;
};

}  // namespace fascia::gpu
