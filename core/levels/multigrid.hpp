#pragma once

#include "core/levels/aggregation.hpp"
#include "core/levels/block_rows.hpp"
#include "core/levels/edge_ends.hpp"
#include "core/linear/vectors.hpp"
#include "core/math/vec3.hpp"
#include "core/structure/model.hpp"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace fascia {

class Corners;

/// Part of r · z at the start of a solve below which rounding alone may make it negative later on.
inline constexpr double kCycleRounding = 1e-12;

/// Chebyshev iterations of degree 2 on D⁻¹ K, for eigenvalues between the largest and a twentieth of it, from the
/// residual r: d = first D⁻¹ r, x += d, r −= K d, x += again d + next D⁻¹ r.
struct Smoothing {
  double first = 0, again = 0, next = 0;
  static Smoothing up_to(double largest);
};

/// Corrections of a level by the next coarser one in a cycle: three between coarse levels, which have a ninth of the
/// nodes of the one above in shells and less in solids, so that these visits cost little. With one alone the iterations
/// of thin shells grow with the number of levels. One of the finest level, whose products are most of the work, and of
/// that above the coarsest, which is solved at once. A level of corners counts as the finest.
constexpr int corrections(std::size_t depth, std::size_t levels) { return depth > 0 && depth + 2 < levels ? 3 : 1; }

/// A preconditioner whose cost grows with the number of unknowns and whose iterations hardly do: smoothed aggregation
/// (Vanek, Mandel, Brezina 1996) in which a coarse node is a rigid frame, whatever its nodes are, so that coarse levels
/// are matrices of 6 × 6 blocks.
///
/// The tentative prolongator is the rigid motion of an aggregate at the present state: u_i = U + Θ × (x_i − x_A), of a
/// frame also θ_i = Θ, of an affine frame dA = skew(Θ) A. P = (I − 4/(3ρ) D⁻¹ K) of it, with D the block diagonal and ρ
/// the largest eigenvalue of D⁻¹ K. A cycle with Chebyshev smoothing of degree 2, several corrections() on the way, and
/// a dense factor of the coarsest level: symmetric and positive definite where K is. Sums run in a fixed order: results
/// do not depend on threads.
///
/// Quadratic elements have a level of their corners between: a vertex in the middle of an edge moves by the mean of its
/// ends. Aggregates of all their nodes, most of which are no corners, take more than twice the iterations.
class Multigrid {
 public:
  /// y = K x on the free degrees of freedom, in constraint axes; those prescribed become 0.
  using Product = std::function<void(std::span<const double> x, std::span<double> y)>;

  /// Where a level's nodes are, and I + D of each of the finest.
  struct Places {
    std::vector<Vec3d> x;
    std::span<const Mat3d> Q;  ///< empty: no node turns
  };

  /// @param matrix  and the filter, stay what they are for as long as this does; the matrix's values may change
  /// @param ends    of a model whose nodes are vertices, half of them or more in the middle of edges: the first coarser
  ///                level is one of corners, of which the others are made. Empty: frames alone
  Multigrid(const BlockMatrix& matrix, const DofFilter& filter, ThreadPool& pool, const EdgeEnds& ends = {});
  ~Multigrid();
  Multigrid(const Multigrid&) = delete;
  Multigrid& operator=(const Multigrid&) = delete;

  /// Makes the levels of the matrix as it is. Aggregates are kept from the first call on.
  /// @param inverse_blocks  of the diagonal, by node: as block Jacobi has them
  /// @return  false where a level is not positive definite
  bool build(const Places& places, std::vector<double> inverse_blocks, const Product& product);

  /// Levels to come keep of prolongators what cycles here read, entries of 32 bits; level() shows none then.
  void keep_rounded_entries() { keeps_exact_ = false; }

  /// z = M⁻¹ r; returns r · z. Calls the product of build().
  double precondition(std::span<const double> r, std::span<double> z);

  /// A level as a cycle needs it, for those that run elsewhere; they know no level of corners.
  struct LevelView {
    int nodes = 0;
    std::span<const Vec3d> x;           ///< where they are
    double largest = 0;                 ///< eigenvalue of D⁻¹ K
    std::span<const double> inverse;    ///< D⁻¹, by node
    const BlockRows* matrix = nullptr;  ///< none of the finest
    const FineRows* fine = nullptr;     ///< of the finest alone, values of the tangent as it was assembled last
    const BlockRows* P = nullptr;       ///< from the next coarser level; none of the coarsest
  };
  std::size_t level_count() const { return levels_.size(); }
  int finest_dofs() const { return matrix_.dofs().total(); }
  LevelView level(std::size_t depth) const;
  /// K⁻¹ of the coarsest level, all entries; empty where its smoother has to do.
  std::vector<double> coarsest_inverse() const;

  /// Nodes of each level, the finest first.
  std::vector<int> level_sizes() const;
  /// Entries of all matrices and prolongators below the finest level.
  std::size_t value_count() const;

 private:
  struct Level;
  struct Coarsest;
  bool add_corners();
  template <class Matrix>
  bool add_coarser(const Matrix& matrix, std::size_t depth);
  void cycle(std::size_t depth);
  void correct(std::size_t depth);
  void smooth(Level& level, bool from_zero);
  double largest_eigenvalue_of(const Level& level) const;

  const BlockMatrix& matrix_;
  const DofFilter& filter_;
  ThreadPool& pool_;
  CpuVectors vectors_;
  std::unique_ptr<FineRows> fine_;
  bool keeps_exact_ = true;           ///< entries of prolongators
  std::unique_ptr<Corners> corners_;  ///< null: none
  std::vector<std::unique_ptr<Level>> levels_;
  std::unique_ptr<Coarsest> coarsest_;
  std::vector<Aggregates> aggregates_;  ///< by level, kept
};

}  // namespace fascia
