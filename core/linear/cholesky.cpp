#include "core/linear/cholesky.hpp"

#include "core/base/index.hpp"
#include "core/linear/supernodal_factor.hpp"

#include <new>
#include <utility>
#include <vector>

namespace fascia {

struct BlockCholesky::Impl {
  SupernodalFactor factor;
  SupernodeSolver solver;
  ThreadPool* pool;
  // Reused by every solve.
  std::vector<int> place;  ///< of each degree of freedom in the factor's order, −1 where prescribed
  std::vector<double> ordered;
  std::vector<float> rounded;  ///< numbers of the factor; empty before one asks for them

  Impl(const BlockMatrix& pattern, const DofFilter& filter, const EliminationOrder& order, ThreadPool* threads)
      : factor(pattern, filter, order, threads),
        solver(factor.pattern().view(std::span<const double>(), {})),
        pool(threads),
        place(filter.size(), -1),
        ordered(at(factor.pattern().columns())) {
    const FactorPattern& made = factor.pattern();
    for (std::size_t k = 0; k < made.node.size(); ++k) {
      int next = made.column[k];
      const int first = pattern.dofs().begin(made.node[k]), end = first + pattern.dofs().size(made.node[k]);
      for (int dof = first; dof < end; ++dof)
        if (!filter.is_fixed(at(dof))) place[at(dof)] = next++;
    }
  }

  bool rounds() const {
    constexpr std::size_t kMany = 100000;  // else the second level of a cache holds them
    return factor.size() > kMany;
  }
  /// False where they are few, or memory does not hold both.
  bool round() {
    if (!rounds()) return false;
    if (!rounded.empty()) return true;
    try {
      rounded.reserve(factor.size());
    } catch (const std::bad_alloc&) {
      return false;
    }
    for (const double number : factor.values()) rounded.push_back(static_cast<float>(number));
    return true;
  }
  template <class T>
  void solve(std::span<const T> values, std::span<const double> b, std::span<double> x) {
    for (std::size_t i = 0; i < b.size(); ++i)
      if (place[i] >= 0) ordered[at(place[i])] = b[i];
    solver.solve(factor.pattern().view(values, factor.sign()), pool, ordered);
    for (std::size_t i = 0; i < b.size(); ++i) x[i] = place[i] >= 0 ? ordered[at(place[i])] : 0.0;
  }
};

BlockCholesky::BlockCholesky(const BlockMatrix& pattern, const DofFilter& filter, const EliminationOrder* order,
                             ThreadPool* pool)
    : impl_(std::make_unique<Impl>(pattern, filter, order != nullptr ? *order : EliminationOrder::of(pattern, filter),
                                   pool)) {}
BlockCholesky::~BlockCholesky() = default;
BlockCholesky::BlockCholesky(BlockCholesky&&) noexcept = default;
BlockCholesky& BlockCholesky::operator=(BlockCholesky&&) noexcept = default;

double BlockCholesky::factor_flops() const { return impl_->factor.pattern().flops; }

double BlockCholesky::factor_bytes() const { return impl_->factor.bytes(); }
double BlockCholesky::number_bytes() const { return sizeof(double) * static_cast<double>(impl_->factor.size()); }

bool BlockCholesky::factorize(const BlockMatrix& matrix, Pivots pivots, double shift, const BlockMatrix* shift_from) {
  impl_->rounded.clear();
  return impl_->factor.factorize(matrix, pivots, shift, shift_from);
}

int BlockCholesky::negative_pivots() const { return impl_->factor.negative_pivots(); }
double BlockCholesky::smallest_pivot() const { return impl_->factor.smallest_pivot(); }

void BlockCholesky::solve(std::span<const double> b, std::span<double> x) const {
  impl_->solve(impl_->factor.values(), b, x);
}

void BlockCholesky::precondition(std::span<const double> b, std::span<double> x) {
  if (!impl_->round()) return solve(b, x);
  impl_->solve(std::span<const float>(impl_->rounded), b, x);
}

double BlockCholesky::rounded_bytes() const {
  return impl_->rounds() ? sizeof(float) * static_cast<double>(impl_->factor.size()) : 0.0;
}

}  // namespace fascia
