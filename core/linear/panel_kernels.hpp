#pragma once

#include "core/math/batch.hpp"

#include <cstddef>

/// Products of small dense matrices by columns, from which a Cholesky factor is made: C −= A B, of tiles that stay in
/// registers, as Goto and van de Geijn describe ("Anatomy of high-performance matrix multiplication", ACM Trans. Math.
/// Softw. 34, 2008). Each number of C is summed in the order of k, wherever its tile lies.
namespace fascia::panel {

inline constexpr int kLanes = kBatchWidth;
inline constexpr int kTileRows = 3 * kLanes;
inline constexpr int kTileColumns = kLanes == 8 ? 8 : 4;

/// The next multiple of a register's numbers.
constexpr int padded(int rows) { return (rows + kLanes - 1) / kLanes * kLanes; }

/// Rows of A as tiles read them: packed, each tile's by columns, one after the other; or in their place.
struct Left {
  const double* first;
  std::size_t stride = 0;  ///< from column to column, of rows in their place; 0: packed
};

/// Packs A (m × k), with zeros up to padded(m).
void pack_left(const double* a, std::size_t stride, int m, int k, double* packed);
/// Packs Bᵀ (n × k by columns) tile by tile, column q times sign[q] where there are signs.
void pack_right(const double* b_transposed, std::size_t stride, int n, int k, const double* sign, double* packed);

/// C −= A B. Whole registers are read and written, up to padded(m) rows: of packed A these are zeros, which change
/// nothing in C; of A in its place they are what lies there.
/// @param lower  numbers with row < column, from the corner of C on, need not be made
void subtract_product(int m, int n, int k, const Left& a, const double* packed_right, double* c, std::size_t stride,
                      bool lower);

/// Some columns of a factor L S Lᵀ with S = diag(±1): of a panel T, whose rows begin with these columns' own, or follow
/// a diagonal block D that is known.
/// @param scratch  columns × kTileColumns numbers
/// @param sign     of the columns, found with their diagonal or given with D; null: positive ones alone
/// @param least    pivots up to these vanish: they have no digit left
/// @return  false: a pivot is not positive, where signs are not asked for; or vanishes, or is no number
bool factorize_diagonal(double* t, std::size_t stride, int rows, int columns, double* sign, const double* least,
                        double* scratch);
void solve_rows(double* t, std::size_t stride, int rows, int columns, const double* d, std::size_t d_stride,
                const double* sign, double* scratch);

}  // namespace fascia::panel
