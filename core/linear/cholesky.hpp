#pragma once

#include "core/linear/block_matrix.hpp"
#include "core/linear/elimination_order.hpp"
#include "core/node/dof_filter.hpp"

#include <memory>
#include <span>

namespace fascia {

/// Pivots that a factorisation accepts: L Lᵀ needs positive ones; L S Lᵀ with S = diag(±1), without pivoting, takes any
/// but zero.
enum class Pivots { positive, any };

/// Cholesky factorisation of a block matrix restricted to its free degrees of freedom. The pattern is analysed once;
/// each factorize() reuses it. Results do not depend on the number of threads.
class BlockCholesky {
 public:
  /// @param order  of elimination where it is known; null: is found
  /// @param pool   belongs to the caller; null: one thread
  BlockCholesky(const BlockMatrix& pattern, const DofFilter& filter, const EliminationOrder* order = nullptr,
                ThreadPool* pool = nullptr);
  ~BlockCholesky();
  BlockCholesky(BlockCholesky&&) noexcept;
  BlockCholesky& operator=(BlockCholesky&&) noexcept;

  double factor_flops() const;  ///< of one factorisation, as analysed
  double factor_bytes() const;  ///< that the first factorize() takes: the numbers, and what each thread works in
  double number_bytes() const;  ///< of the numbers alone, whatever the number of threads

  /// False where the matrix is not positive definite; of Pivots::any, where a pivot vanishes. A pivot below the
  /// rounding of the matrix's own number there (2.2e-16 of it) counts as none.
  /// @param shift  added to the diagonal, relative to the diagonal of `shift_from`: K + shift · diag
  /// @throws std::bad_alloc  the factor does not fit into memory, which it takes here
  bool factorize(const BlockMatrix& matrix, Pivots pivots = Pivots::positive, double shift = 0,
                 const BlockMatrix* shift_from = nullptr);

  /// Number of negative pivots of the last factorisation: by Sylvester's law that of the matrix's negative eigenvalues.
  int negative_pivots() const;
  /// The smallest pivot of the last factorisation, relative to the matrix's own number there.
  double smallest_pivot() const;

  /// Solves in constraint axes; prescribed entries of `x` are set to zero.
  void solve(std::span<const double> b, std::span<double> x) const;
  /// About what solve() gives, with the numbers of the factor rounded to 32 bits where they are many: half as much to
  /// read, as a preconditioner. It is symmetric, and definite where no pivot is negative.
  void precondition(std::span<const double> b, std::span<double> x);
  /// Bytes that precondition() keeps beside the factor.
  double rounded_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascia
