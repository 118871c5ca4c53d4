#include "core/linear/cholesky.hpp"
#include "core/linear/cholmod_factor.hpp"

#include <cholmod.h>

#include <cstdint>
#include <memory>
#include <new>
#include <variant>

namespace fascia {

namespace {

EliminationOrder order_by(NodeGraph& graph, int method) {
  cholmod_common common{};
  cholmod_start(&common);
  common.print = 0;
  common.supernodal = CHOLMOD_SIMPLICIAL;
  common.nmethods = 1;
  common.method[0].ordering = method;
  cholmod_sparse sparse = lower_triangle(graph.column_begin, graph.row);
  cholmod_factor* analysed = cholmod_analyze(&sparse, &common);
  EliminationOrder order;
  if (analysed != nullptr) {
    const auto *permutation = static_cast<const int*>(analysed->Perm), *counts = static_cast<int*>(analysed->ColCount);
    order = graph.counted({permutation, permutation + analysed->n}, {counts, counts + analysed->n});
  }
  const bool made = analysed != nullptr;
  cholmod_free_factor(&analysed, &common);
  cholmod_finish(&common);
  if (!made) throw std::bad_alloc();
  return order;
}

}  // namespace

/// Minimum degree; where the factor fills much, nested dissection too: by the measures that CHOLMOD itself has for it,
/// which it takes of the matrix of single degrees of freedom. That takes several times as long.
EliminationOrder EliminationOrder::of(const BlockMatrix& pattern, const DofFilter& filter, double enough) {
  NodeGraph graph(pattern, filter);
  EliminationOrder order = order_by(graph, CHOLMOD_AMD);
  const double entries = 0.5 * static_cast<double>(pattern.value_count()) * (pattern.fills_upper() ? 2 : 1);
  if (order.flops < 500 * order.numbers || order.numbers < 5 * entries) return order;
  order.rough = true;
  if (order.exceeds(enough)) return order;
  order.rough = false;
  EliminationOrder dissected = order_by(graph, CHOLMOD_METIS);
  return dissected.numbers < order.numbers ? dissected : order;
}

struct BlockCholesky::Impl {
  std::variant<std::monostate, CholmodFactor<int>, CholmodFactor<std::int64_t>> factor;

  Impl(const BlockMatrix& pattern, const DofFilter& filter, Pivots pivots, const EliminationOrder& order,
       ThreadPool* pool) {
    if (order.narrow())
      factor.emplace<CholmodFactor<int>>(pattern, filter, pivots, order, pool);
    else
      factor.emplace<CholmodFactor<std::int64_t>>(pattern, filter, pivots, order, pool);
  }

  /// act(the factor)
  template <class Act>
  auto with(const Act& act) {
    if (auto* narrow = std::get_if<CholmodFactor<int>>(&factor)) return act(*narrow);
    return act(std::get<CholmodFactor<std::int64_t>>(factor));
  }
};

BlockCholesky::BlockCholesky(const BlockMatrix& pattern, const DofFilter& filter, Pivots pivots,
                             const EliminationOrder* order, ThreadPool* pool)
    : impl_(std::make_unique<Impl>(pattern, filter, pivots,
                                   order != nullptr ? *order : EliminationOrder::of(pattern, filter), pool)) {}
BlockCholesky::~BlockCholesky() = default;
BlockCholesky::BlockCholesky(BlockCholesky&&) noexcept = default;
BlockCholesky& BlockCholesky::operator=(BlockCholesky&&) noexcept = default;

double BlockCholesky::factor_flops() const {
  return impl_->with([](const auto& factor) { return factor.flops(); });
}

double BlockCholesky::factor_bytes() const {
  return impl_->with([](const auto& factor) { return factor.bytes(); });
}

bool BlockCholesky::factorize(const BlockMatrix& matrix, double shift, const BlockMatrix* shift_from) {
  return impl_->with([&](auto& factor) { return factor.factorize(matrix, shift, shift_from); });
}

int BlockCholesky::negative_pivots() const {
  return impl_->with([](const auto& factor) { return factor.negative_pivots(); });
}

void BlockCholesky::solve(std::span<const double> b, std::span<double> x) const {
  impl_->with([&](auto& factor) { factor.solve(b, x); });
}

void BlockCholesky::precondition(std::span<const double> b, std::span<double> x) {
  impl_->with([&](auto& factor) { factor.precondition(b, x); });
}

double BlockCholesky::rounded_bytes() const {
  return impl_->with([](const auto& factor) { return factor.rounded_bytes(); });
}

}  // namespace fascia
