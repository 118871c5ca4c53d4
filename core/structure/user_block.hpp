#pragma once

#include "core/base/index.hpp"
#include "core/math/mat3.hpp"
#include "core/physics/point_physics.hpp"

#include <span>
#include <vector>

namespace fascia {

/// A node as a cell of a UserBlock sees it: its displacement [m], and Q − I or A − I (zero of a vertex).
struct CellPose {
  Vec3d u{};
  Mat3d D{};
};
/// A small motion of a node: of its place and of Q or A.
struct CellMotion {
  Vec3d dx{};
  Mat3d dA{};
};
/// Conjugate to it: ∂ψ/∂u [N] and ∂ψ/∂D [N m].
struct CellForce {
  Vec3d force{};
  Mat3d N{};
};

/// Matter of the caller's own between nodes: cells with an energy of the poses of their nodes. It goes with the points,
/// elements and shells of a model through statics, dynamics, explicit steps and modes on the processor. Rotations of
/// rigid frames need no care: the energy is one of u and D, and the derivatives are those with respect to their
/// entries.
///
/// Cells are computed on all threads: the functions of a cell change nothing, and must not throw.
class UserBlock {
 public:
  /// @param cell_nodes   number of nodes of a cell
  /// @param cells        nodes of the model, cell after cell; no node twice in a cell
  /// @param cell_length  distance of a cell's nodes: its cube weighs the cell in the length of its part, which compares
  ///                     torques with forces; times stiffness() it is the cell's stiffness in N/m
  /// @throws InputError  where these do not fit together
  UserBlock(int cell_nodes, std::vector<int> cells, double cell_length);
  virtual ~UserBlock() = default;
  UserBlock(const UserBlock&) = delete;
  UserBlock& operator=(const UserBlock&) = delete;

  /// The energy of a cell [J]. Adds its gradient. @param poses, gradient  (nodes)
  virtual double forces(int cell, std::span<const CellPose> poses, std::span<CellForce> gradient) const = 0;
  /// Adds the second derivative times a motion: symmetric. For Tangent::material a part of it that is never negative.
  virtual void product(int cell, std::span<const CellPose> poses, Tangent tangent, std::span<const CellMotion> motions,
                       std::span<CellForce> out) const = 0;
  /// The elastic modulus that its matter would have [Pa]: tells stiff parts from soft ones, and forces from rounding.
  virtual double stiffness(int cell) const = 0;
  /// The longest part of a step, up to 1, that a cell allows: where its energy has no value beyond. Newton's method
  /// asks before each step that it takes.
  virtual double largest_step(int /*cell*/, std::span<const CellPose> /*poses*/,
                              std::span<const CellMotion> /*motions*/) const {
    return 1;
  }
  /// Rotation of a cell by small displacements of its nodes [rad], as far as frames do not show it: Newton's method
  /// takes no step that turns one by more than a right angle or so.
  virtual double spin(int /*cell*/, std::span<const Vec3d> /*dx*/) const { return 0; }

  std::span<const int> cell(int index) const { return std::span(cells_).subspan(at(index) * at(nodes), at(nodes)); }
  /// Calls act(nodes, stiffness [Pa]) for each cell, as all blocks do (blocks.hpp).
  template <class Act>
  void for_each_cell(const Act& act) const {
    for (int c = 0; c < count(); ++c) act(cell(c), stiffness(c));
  }
  double stiffness_sum() const {
    double sum = 0;
    for (int c = 0; c < count(); ++c) sum += stiffness(c) * length;
    return sum;
  }

  int count() const { return static_cast<int>(cells_.size()) / nodes; }
  /// How often the cells have changed.
  long revision() const { return revision_; }

  const int nodes;
  const double length;
  static constexpr bool averaged = false;  ///< as ElementBlock has it

 protected:
  /// Gives the block other cells: pairs that have come near one another, bonds that broke. Between the steps of a run;
  /// all that was made of the pattern of the matrix is then made anew.
  /// @throws InputError  as the constructor; the cells stay what they were
  void set_cells(std::vector<int> cells);

 private:
  void check(const std::vector<int>& cells) const;

  std::vector<int> cells_;
  long revision_ = 0;
};

}  // namespace fascia
