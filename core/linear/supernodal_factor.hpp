#pragma once

#include "core/base/aligned.hpp"
#include "core/base/thread_pool.hpp"
#include "core/linear/cholesky.hpp"
#include "core/linear/factor_pattern.hpp"
#include "core/linear/factor_tasks.hpp"
#include "core/linear/supernodes.hpp"

#include <atomic>
#include <memory>
#include <span>
#include <vector>

namespace fascia {

/// The numbers of a factor L S Lᵀ by supernodes, with S = diag(±1): the factor of a symmetric matrix that need not be
/// positive definite. It is made from left to right: the columns of a supernode gather what all before it bring them,
/// in a fixed order, in parts that stay in a processor's cache, then are divided by their diagonal. Threads share
/// subtrees of the elimination tree, and the rows of the supernodes on top of them; the sum of no number depends on
/// who does what.
class SupernodalFactor {
 public:
  SupernodalFactor(const BlockMatrix& pattern, const DofFilter& filter, const EliminationOrder& order,
                   ThreadPool* pool);

  const FactorPattern& pattern() const { return pattern_; }
  double bytes() const;  ///< of the numbers, and what each thread works in

  /// This is BlockCholesky::factorize().
  bool factorize(const BlockMatrix& matrix, Pivots pivots, double shift, const BlockMatrix* shift_from);
  int negative_pivots() const;
  double smallest_pivot() const;

  std::span<const double> values() const { return {values_.get(), size()}; }
  std::size_t size() const { return static_cast<std::size_t>(pattern_.value_begin.back()); }
  std::span<const double> sign() const { return sign_; }

 private:
  /// A block of the matrix in the column of one of its nodes.
  struct Entry {
    int block;
    int row;  ///< node of the row in the order of elimination; ~node: the block is that of the row's node, and turned
  };
  struct Scratch {
    AlignedVector<double> panel, product, left, right;
    std::vector<int> place;  ///< of each row of the factor among those of the supernode `placed`
    std::vector<int> rows;
    int placed = -1;
  };
  struct AlignedDelete {
    void operator()(double* p) const { ::operator delete[](p, std::align_val_t{64}); }
  };
  /// The largest part of a supernode, with what tiles may touch beyond its rows.
  struct Room {
    std::size_t rows = 0, columns = 0;
  };
  struct Source {
    const BlockMatrix* matrix;
    double shift;
    const BlockMatrix* shift_from;
  };
  void list_entries(const BlockMatrix& pattern);
  Room room() const;
  void make_supernode(int s, Scratch& scratch);
  void make(const FactorTasks::Task& task, Scratch& scratch);
  /// Steps of it, for rows [begin, end) of a supernode.
  void gather(int s, int begin, int end, Scratch& scratch);
  void add_matrix(int s, int begin, int end, Scratch& scratch) const;
  void subtract(int s, int begin, int end, const FactorPattern::Descendant& from, Scratch& scratch) const;
  void divide(int s, int begin, int end, Scratch& scratch);
  void load(int s, int begin, int end, Scratch& scratch) const;
  void store(int s, int begin, int end, const Scratch& scratch);

  double* values_of(int s) { return values_.get() + pattern_.value_begin[at(s)]; }
  const double* values_of(int s) const { return values_.get() + pattern_.value_begin[at(s)]; }
  const double* sign_from(int column) const { return sign_.empty() ? nullptr : sign_.data() + column; }

  const DofFilter& filter_;
  FactorPattern pattern_;
  std::vector<Entry> entry_;
  std::vector<std::size_t> entry_begin_;  ///< of each node in the order of elimination, and of the end
  std::vector<unsigned> fixed_;           ///< DofFilter::fixed_of() of each
  std::vector<double> sign_;              ///< S; empty where all have to be positive
  std::vector<double> least_;             ///< pivots up to these vanish: kVanished of the matrix's diagonal
  std::unique_ptr<double[], AlignedDelete> values_;
  ThreadPool* pool_;
  FactorTasks tasks_;
  std::vector<Scratch> scratch_;  ///< of each thread
  Source source_{};
  std::atomic<bool> failed_{false};
};

}  // namespace fascia
