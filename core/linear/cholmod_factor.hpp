#pragma once

#include "core/base/index.hpp"
#include "core/linear/blas.hpp"
#include "core/linear/cholesky.hpp"
#include "core/linear/elimination_order.hpp"
#include "core/linear/free_matrix.hpp"
#include "core/linear/supernodes.hpp"

#include <cholmod.h>

#include <algorithm>
#include <cstdint>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

namespace fascia {

/// CHOLMOD by the width of its indices: names of its functions begin with cholmod_ or cholmod_l_.
template <class Int>
struct Cholmod;

template <>
struct Cholmod<int> {
  static constexpr int kIndices = CHOLMOD_INT;
  static constexpr auto start = cholmod_start;
  static constexpr auto finish = cholmod_finish;
  static constexpr auto analyze_in_order = cholmod_analyze_p;
  static constexpr auto factorize = cholmod_factorize;
  static constexpr auto solve = cholmod_solve2;
  static constexpr auto zeros = cholmod_zeros;
  static constexpr auto free_dense = cholmod_free_dense;
  static constexpr auto free_factor = cholmod_free_factor;
};

template <>
struct Cholmod<std::int64_t> {
  static_assert(std::is_same_v<std::int64_t, SuiteSparse_long>);
  static constexpr int kIndices = CHOLMOD_LONG;
  static constexpr auto start = cholmod_l_start;
  static constexpr auto finish = cholmod_l_finish;
  static constexpr auto analyze_in_order = cholmod_l_analyze_p;
  static constexpr auto factorize = cholmod_l_factorize;
  static constexpr auto solve = cholmod_l_solve2;
  static constexpr auto zeros = cholmod_l_zeros;
  static constexpr auto free_dense = cholmod_l_free_dense;
  static constexpr auto free_factor = cholmod_l_free_factor;
};

/// Fields of a lower triangle by columns that do not depend on its values.
template <class Int>
cholmod_sparse lower_triangle(std::vector<Int>& column_begin, std::vector<Int>& row) {
  cholmod_sparse sparse{};
  sparse.nrow = sparse.ncol = column_begin.size() - 1;
  sparse.nzmax = row.size();
  sparse.p = column_begin.data();
  sparse.i = row.data();
  sparse.stype = -1;
  sparse.itype = Cholmod<Int>::kIndices;
  sparse.xtype = CHOLMOD_PATTERN;
  sparse.dtype = CHOLMOD_DOUBLE;
  sparse.sorted = 1;
  sparse.packed = 1;
  return sparse;
}

/// A factor as BlockCholesky promises it, with indices of one width. Those of 64 bits take twice the memory of indices,
/// of which supernodes have few.
template <class Int>
class CholmodFactor {
 public:
  CholmodFactor(const BlockMatrix& pattern, const DofFilter& filter, Pivots pivots, const EliminationOrder& order,
                ThreadPool* pool)
      : matrix_(pattern, filter), filter_(filter), pool_(pool) {
    hold_blas_to_one_thread();
    own_.common.print = 0;
    own_.common.quick_return_if_not_posdef = 1;
    own_.common.final_ll = pivots == Pivots::positive;  // LDLᵀ, its choice for small matrices, accepts negative pivots
    if (pivots == Pivots::any) own_.common.supernodal = CHOLMOD_SIMPLICIAL;
    own_.common.nmethods = 1;
    own_.common.method[0].ordering = CHOLMOD_GIVEN;
    const auto n = static_cast<std::size_t>(matrix_.size);
    sparse_ = lower_triangle(matrix_.column_begin, matrix_.row);
    sparse_.x = matrix_.value.data();
    sparse_.xtype = CHOLMOD_REAL;
    const std::vector<int> numbers = matrix_.numbers_of(order.nodes, pattern.dofs());
    std::vector<Int> permutation(numbers.begin(), numbers.end());
    own_.factor = Calls::analyze_in_order(&sparse_, permutation.data(), nullptr, 0, &own_.common);
    own_.rhs = Calls::zeros(n, 1, CHOLMOD_REAL, &own_.common);
    if (own_.factor == nullptr || own_.rhs == nullptr) throw std::bad_alloc();
    if (own_.factor->is_super == 0) return;
    take_blas_buffer();
    std::vector<int> place_of(n);
    const auto* kth = static_cast<const Int*>(own_.factor->Perm);
    for (std::size_t k = 0; k < n; ++k) place_of[static_cast<std::size_t>(kth[k])] = static_cast<int>(k);
    for (const int number : matrix_.number) place_.push_back(number < 0 ? -1 : place_of[at(number)]);
    ordered_.resize(n);
    solver_ = SupernodeSolver(supernodes(numbers_of_factor()));
  }

  double flops() const { return own_.common.fl; }

  /// The peak of a factorisation, beside what the analysis has left: CHOLMOD holds the matrix in its own order then,
  /// and once more while it orders it (cholmod_factorize_p). Supernodes are dense, of which one is updated at a time;
  /// else columns have room to grow, by Common->grow1 and grow2.
  double bytes() const {
    constexpr double number = sizeof(double), entry = sizeof(Int) + sizeof(double);
    const auto n = static_cast<double>(own_.factor->n);
    const double matrix = entry * static_cast<double>(matrix_.row.size()) + sizeof(Int) * n;
    if (own_.factor->is_super == 0)
      return entry * (own_.common.grow1 * own_.common.lnz + static_cast<double>(own_.common.grow2) * n) + matrix +
             4 * number * n;
    return number * (static_cast<double>(own_.factor->xsize) + 4 * n) + matrix +
           std::max(matrix, number * static_cast<double>(own_.factor->maxcsize));
  }

  bool factorize(const BlockMatrix& matrix, double shift, const BlockMatrix* shift_from) {
    matrix_.fill(matrix, filter_, shift, shift_from);
    rounded_.clear();
    Calls::factorize(&sparse_, own_.factor, &own_.common);
    if (own_.common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    return own_.common.status == CHOLMOD_OK && own_.factor->minor == own_.factor->n;
  }

  int negative_pivots() const {
    if (own_.factor->is_ll != 0) return 0;
    const auto* begin = static_cast<const Int*>(own_.factor->p);
    const auto* value = static_cast<const double*>(own_.factor->x);  // D stands first in each column
    int count = 0;
    for (std::size_t j = 0; j < own_.factor->n; ++j) count += value[begin[j]] < 0 ? 1 : 0;
    return count;
  }

  void solve(std::span<const double> b, std::span<double> x) {
    if (own_.factor->is_super != 0) return solve_by_supernodes(numbers_of_factor(), b, x);
    auto* rhs = static_cast<double*>(own_.rhs->x);
    for (std::size_t i = 0; i < b.size(); ++i)
      if (matrix_.number[i] >= 0) rhs[matrix_.number[i]] = b[i];
    if (Calls::solve(CHOLMOD_A, own_.factor, own_.rhs, nullptr, &own_.solution, nullptr, &own_.work_y, &own_.work_e,
                     &own_.common) == 0)
      throw std::bad_alloc();
    const auto* solution = static_cast<const double*>(own_.solution->x);
    for (std::size_t i = 0; i < b.size(); ++i) x[i] = matrix_.number[i] >= 0 ? solution[matrix_.number[i]] : 0.0;
  }

  void precondition(std::span<const double> b, std::span<double> x) {
    if (own_.factor->is_super == 0 || !round()) return solve(b, x);
    solve_by_supernodes(std::span<const float>(rounded_), b, x);
  }

  double rounded_bytes() const {
    return own_.factor->is_super == 0 ? 0.0 : sizeof(float) * static_cast<double>(own_.factor->xsize);
  }

 private:
  using Calls = Cholmod<Int>;

  std::span<const double> numbers_of_factor() const {
    return {static_cast<const double*>(own_.factor->x), own_.factor->xsize};
  }
  template <class T>
  Supernodes<T, Int> supernodes(std::span<const T> values) const {
    const std::size_t count = own_.factor->nsuper;
    const auto indices = [](const void* p, std::size_t n) { return std::span(static_cast<const Int*>(p), n); };
    return {indices(own_.factor->super, count + 1), indices(own_.factor->pi, count + 1),
            indices(own_.factor->px, count + 1), indices(own_.factor->s, own_.factor->ssize), values};
  }
  /// False where memory does not hold both.
  bool round() {
    if (!rounded_.empty()) return true;
    try {
      rounded_.reserve(numbers_of_factor().size());
    } catch (const std::bad_alloc&) {
      return false;
    }
    for (const double number : numbers_of_factor()) rounded_.push_back(static_cast<float>(number));
    return true;
  }
  template <class T>
  void solve_by_supernodes(std::span<const T> values, std::span<const double> b, std::span<double> x) {
    for (std::size_t i = 0; i < b.size(); ++i)
      if (place_[i] >= 0) ordered_[at(place_[i])] = b[i];
    solver_.solve(supernodes(values), pool_, ordered_);
    for (std::size_t i = 0; i < b.size(); ++i) x[i] = place_[i] >= 0 ? ordered_[at(place_[i])] : 0.0;
  }

  /// Owns what CHOLMOD allocates, also where the constructor throws.
  struct Owned {
    cholmod_common common{};
    cholmod_factor* factor = nullptr;
    cholmod_dense *rhs = nullptr, *solution = nullptr, *work_y = nullptr, *work_e = nullptr;

    Owned() { Calls::start(&common); }
    ~Owned() {
      for (cholmod_dense** vector : {&rhs, &solution, &work_y, &work_e}) Calls::free_dense(vector, &common);
      Calls::free_factor(&factor, &common);
      Calls::finish(&common);
    }
    Owned(const Owned&) = delete;
    Owned& operator=(const Owned&) = delete;
  };

  FreeMatrix<Int> matrix_;
  const DofFilter& filter_;
  Owned own_;
  cholmod_sparse sparse_{};
  // Of supernodes, reused by every solve.
  std::vector<int> place_;  ///< of each degree of freedom in the factor's order, −1 where prescribed
  std::vector<double> ordered_;
  SupernodeSolver solver_;
  ThreadPool* pool_;
  std::vector<float> rounded_;  ///< numbers of the factor; empty before one asks for them
};

}  // namespace fascia
