#pragma once

#include "core/executor/executor.hpp"
#include "core/executor/lane_frames.hpp"

#include <cstddef>
#include <optional>

namespace fascia::app {

/// Counts what a kernel cannot do without. Each array that it reads or writes counts once, as the data structures hold
/// it, however often the kernel comes back to it; sums that wait between two passes count nothing, since another kernel
/// could do without them. The counts are lower bounds, so that a rate made of them is one too.
struct Traffic {
  double read = 0, written = 0;  ///< [bytes]
  double updated = 0;            ///< of those written, what was read from the same place
  std::optional<double> flops;   ///< multiplications and additions; none where no count is well founded

  double bytes() const { return read + written; }
  double working_set() const { return read + written - updated; }
};

/// Multiplications and additions of the formulas of St Venant-Kirchhoff points without ties, entries of a symmetric
/// matrix once. Like bytes they are lower bounds: nothing counts that is alike for all points of a frame, nor what
/// moves numbers between lanes. Other laws and shells are not counted.
///
/// Forces of points: for an influence u gᵀ + D B 72, P g 15, P Bᵀ 45 and 12 to add them; where the frame carries its
/// surroundings (u + D r) gᵀ + w D 54 and P g rᵀ + w P 27 in the place of 72 and 45. For a point E 45, S 12, P 54,
/// v P 9. Linearisation: the same motion, with w D 18, and E and S. Product: the same motion and sums for an influence;
/// for a point dE 57, dS 12, dS + H dS + dH S 108, v dP 9.
///
/// Forces of elements: for a node of a point u gᵀ 18, P g and to add it 18; for a point as above. Product: for a node
/// two motions 36 and 18; for a point E and S 57, dE 51, dS 12, F dS + dF S 99, v dP 9.
struct Operations {
  double forces = 0, linearization = 0, product = 0;
};

/// Traffic of the kernels on a point set, without damping and stresses that fade.
class TrafficCount {
 public:
  explicit TrafficCount(const PointSet& set);

  /// Integration points of groups and elements, and triangles of shells.
  double points() const { return points_; }

  /// Constants of all blocks, displacements and rotations in, the gradient out.
  Traffic forces() const;

  /// In: what forces() reads, where a block keeps anything, else the state alone, and the moment of each turning frame.
  /// Out: the linearisation.
  Traffic linearization(const Linearization& lin) const;

  /// In: direction, constants, own blocks of nodes, rotations of turning frames; of points H and S that are kept, and
  /// what drilling or an affine frame needs beside; of elements and shells the state. Out: the product.
  Traffic product(const Linearization& lin) const;

  /// In: what the product reads but for the direction, and for each pair of nodes that an item moves the number of its
  /// block. Out: the values of the matrix.
  Traffic assembly(const Linearization& lin, const BlockMatrix& matrix) const;

 private:
  double state() const;
  double turning() const;
  void count_groups();
  void count_elements();
  void count_shells();
  /// @param influences  pairs of a point and a frame that moves it
  /// @param carried     the frames carry their surroundings (LaneFrames::carries())
  void add_operations_of_points(const PointRule& rule, double points, double influences, bool carried);
  void add_operations(const ElementBlock& block);
  std::optional<double> counted(double operations) const;

  const PointSet& set_;
  double points_ = 0;
  double constants_ = 0;        ///< of all blocks [bytes]
  double group_constants_ = 0;  ///< of groups of points [bytes]
  double kept_ = 0;             ///< of what groups keep, what a product reads [bytes]
  double pairs_ = 0;            ///< numbers of blocks [bytes]
  double vertices_ = 0;         ///< nodes that do not turn
  bool sees_state_again_ = false;
  bool counts_operations_ = true;
  Operations operations_;
};

/// In: each stored value, the column of each stored block, where rows begin, and x. Out: y. Flops: two for each entry
/// of the whole matrix, so four for one above the diagonal where the other half is not stored.
Traffic assembled_product_traffic(const BlockMatrix& matrix);

/// x · y: 16 bytes and 2 flops an unknown.
Traffic dot_traffic(std::size_t unknowns);

/// x += s p and r −= s q in one pass, as CG has them: 32 bytes in, 16 out, 4 flops an unknown.
Traffic axpy_traffic(std::size_t unknowns);

}  // namespace fascia::app
