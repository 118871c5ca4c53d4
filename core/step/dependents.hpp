#pragma once

#include "core/space/array.hpp"
#include "core/space/row_sums.hpp"
#include "core/step/model_view.hpp"

#include <vector>

namespace fascia {

/// Dependent nodes, and pairs of one and a host of it. Both are sorted by level.
struct DependentsView {
  const int *node = nullptr, *pair_begin = nullptr;
  const int* index = nullptr;  ///< in PointSet::dependents
  const char* turns = nullptr;
  const int *dependent = nullptr, *host = nullptr;  ///< of each pair
  const FrameKind* kind = nullptr;                  ///< of its host
  const double* w = nullptr;
  const Vec3d* b = nullptr;
  Vec3d* lever = nullptr;  ///< Q b of rigid hosts, b of others [m]

  /// The host of the pair turns the dependent node.
  FASCIA_HD bool carries(int pair) const {
    const int k = dependent[pair];
    return turns[k] != 0 && pair == pair_begin[k];
  }
  FASCIA_HD int dofs(const NodesView& nodes, int k) const { return turns[k] != 0 ? nodes.size(node[k]) : 3; }

  /// Adds Jᵀ f of what acts on a dependent node to the entries of a host.
  FASCIA_HD void add_to_host(int pair, const double* f, Sums<kMostDofs>& host_sums) const {
    const Vec3d force{{f[0], f[1], f[2]}};
    for (int i = 0; i < 3; ++i) host_sums.v[i] += w[pair] * f[i];
    if (kind[pair] == FrameKind::rigid) {
      const Vec3d torque = cross(lever[pair], force);
      const bool whole = carries(pair);
      for (int i = 0; i < 3; ++i) host_sums.v[3 + i] += torque[i] + (whole ? f[3 + i] : 0.0);
    } else if (kind[pair] == FrameKind::affine) {
      for (int q = 0; q < 3; ++q)
        for (int i = 0; i < 3; ++i) host_sums.v[3 + 3 * q + i] += lever[pair][q] * force[i];
    }
  }
  /// A column of J: how a degree of freedom of the host moves the dependent node. @param column  (6), zero before
  FASCIA_HD void host_column(int pair, int dof, double* column) const {
    const Vec3d& l = lever[pair];
    if (dof < 3) {
      column[dof] = w[pair];
    } else if (kind[pair] == FrameKind::affine) {
      column[(dof - 3) % 3] = l[(dof - 3) / 3];
    } else {
      Vec3d e;
      e[dof - 3] = 1;
      const Vec3d dx = cross(e, l);
      for (int i = 0; i < 3; ++i) column[i] = dx[i];
      if (carries(pair)) column[dof] = 1;
    }
  }
};

/// The dependent nodes of a model at a state, where small motions of their hosts move them by
///
///   dx = Σ w dx_a + dA_a b_a,   and where they turn   dr = dr_a,   briefly d = J d_hosts.
///
/// Vectors of all degrees of freedom become those of the free ones: with d = T d', all of d from the rest, g' = Tᵀ g,
/// in which the entries of what depends are zero; matrices likewise (core/tangent/condensation.hpp). Hosts of a level
/// depend on nodes of lower levels alone; a pass goes through the levels. All pointers point into the space.
template <class Space>
class Dependents {
 public:
  explicit Dependents(const PointSet& set, Space space = Space());

  bool empty() const { return levels_.empty(); }
  const DependentsView& view() const { return view_; }
  int count() const { return levels_.empty() ? 0 : levels_.back().begin + levels_.back().count; }
  /// How much larger than the rounding of forces that of torques is on a part's hosts, with torques over the part's
  /// length; 1 where nothing depends. (parts)
  const std::vector<double>& leverage() const { return leverage_; }

  /// Puts dependent nodes where their hosts take them. @param D  null where no node turns, here and below
  void place(Vec3d* u, Mat3d* D) const;
  /// Gives dependent nodes the velocities and dQ/dt that follow from those of their hosts.
  void place_rates(Vec3d* v, Mat3d* Q_dot) const { place(v, Q_dot); }
  /// Gives dependent nodes the motions since the start of a step that follow from those of their hosts: u = u₀ + du,
  /// and Q = (I + Ds) Q₀ or A = A₀ + Ds.
  /// @param start_D  D at the start
  void place_increments(Vec3d* du, Mat3d* Ds, const Mat3d* start_D) const;

  /// Takes the rotations of a state, for all that follows.
  void turn(const Mat3d* D);
  /// @param Q  I + D of each node
  void turn_to(const Mat3d* Q);

  /// Entries of dependent nodes of a direction, from those of their hosts.
  /// @param dx, dA  take the motion of each node by displacement and dA, where they are given
  /// @param Q       I + D of each node; needed with dA
  void expand(const NodesView& nodes, double* d, Vec3d* dx = nullptr, Mat3d* dA = nullptr,
              const Mat3d* Q = nullptr) const;
  /// Moves forces on dependent nodes to their hosts.
  /// @param forces  (dependents × 6) takes what each hands on, with what it had from those that depend on it: the
  ///                force, and where it turns the torque about it; or null
  void transfer(const NodesView& nodes, double* g, double* forces = nullptr);
  /// Adds to the nodes' own blocks the second derivative of the dependent nodes' places, f · Q b along rotations of
  /// their hosts. @param forces  as transfer() kept them, of a gradient
  void add_turning(const NodesView& nodes, const double* forces, double* node_blocks);

  /// Moves the own blocks of dependent nodes to their hosts, each as Jᵀ K_vv J, and leaves the identity in their place.
  /// Couplings of a dependent node with other nodes are left out: the blocks stay positive definite, but are not those
  /// of the condensed matrix.
  void add_diagonal(const NodesView& nodes, double* blocks);

 private:
  struct Level {
    int begin = 0, count = 0;  ///< dependents
    int first_pair = 0;
    Array<Space, int> hosts;
    RowSums<Space> by_host;  ///< pairs, from the first one on
  };

  Space space_;
  std::vector<Level> levels_;
  int most_host_dofs_ = 0, pairs_ = 0;
  Array<Space, int> node_, pair_begin_, index_, dependent_, host_;
  Array<Space, char> turns_;
  Array<Space, FrameKind> kind_;
  Array<Space, double> w_;
  Array<Space, Vec3d> b_, lever_;
  DependentsView view_;
  std::vector<double> leverage_;
};

/// Puts dependent nodes of a state where their hosts take them.
void place_dependents(const PointSet& set, State& state);
/// Velocities of dependent nodes, du/dt = Σ w du_a/dt + dQ_a/dt b_a.
void place_dependent_rates(const PointSet& set, State& state);

}  // namespace fascia
