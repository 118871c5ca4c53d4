#include "core/base/index.hpp"
#include "core/linear/blas.hpp"
#include "core/linear/cholesky.hpp"
#include "core/linear/free_matrix.hpp"
#include "core/linear/supernodes.hpp"

#include <cholmod.h>

#include <algorithm>
#include <new>
#include <vector>

namespace fascia {

namespace {

/// Fields of a lower triangle by columns that do not depend on its values.
cholmod_sparse lower_triangle(std::vector<int>& column_begin, std::vector<int>& row) {
  cholmod_sparse sparse{};
  sparse.nrow = sparse.ncol = column_begin.size() - 1;
  sparse.nzmax = row.size();
  sparse.p = column_begin.data();
  sparse.i = row.data();
  sparse.stype = -1;
  sparse.itype = CHOLMOD_INT;
  sparse.xtype = CHOLMOD_PATTERN;
  sparse.dtype = CHOLMOD_DOUBLE;
  sparse.sorted = 1;
  sparse.packed = 1;
  return sparse;
}

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
  EliminationOrder order;
  FreeMatrix matrix;
  const DofFilter& filter;
  cholmod_common common{};
  cholmod_sparse sparse{};
  cholmod_factor* factor = nullptr;
  // Reused by every solve: of supernodes
  std::vector<int> place;  ///< of each degree of freedom in the factor's order, −1 where prescribed
  std::vector<double> ordered;
  SupernodeSolver solver;
  ThreadPool* pool;
  std::vector<float> rounded;  ///< numbers of the factor; empty before one asks for them
  // and of single columns.
  cholmod_dense *rhs = nullptr, *solution = nullptr, *work_y = nullptr, *work_e = nullptr;

  Impl(const BlockMatrix& pattern, const DofFilter& f, Pivots pivots, const EliminationOrder* known,
       ThreadPool* threads)
      : order(known != nullptr ? *known : EliminationOrder::of(pattern, f)), filter(f), pool(threads) {
    order.expect_to_fit();
    matrix = FreeMatrix(pattern, f);
    hold_blas_to_one_thread();
    cholmod_start(&common);
    common.print = 0;
    common.quick_return_if_not_posdef = 1;
    common.final_ll = pivots == Pivots::positive;  // LDLᵀ, its choice for small matrices, accepts negative pivots
    if (pivots == Pivots::any) common.supernodal = CHOLMOD_SIMPLICIAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    const auto n = static_cast<std::size_t>(matrix.size);
    sparse = lower_triangle(matrix.column_begin, matrix.row);
    sparse.x = matrix.value.data();
    sparse.xtype = CHOLMOD_REAL;
    std::vector<int> permutation = matrix.numbers_of(order.nodes, pattern.dofs());
    factor = cholmod_analyze_p(&sparse, permutation.data(), nullptr, 0, &common);
    rhs = cholmod_zeros(n, 1, CHOLMOD_REAL, &common);
    if (factor == nullptr || rhs == nullptr) throw std::bad_alloc();
    if (factor->is_super == 0) return;
    take_blas_buffer();
    std::vector<int> place_of(n);
    for (std::size_t k = 0; k < n; ++k) place_of[at(static_cast<const int*>(factor->Perm)[k])] = static_cast<int>(k);
    for (const int number : matrix.number) place.push_back(number < 0 ? -1 : place_of[at(number)]);
    ordered.resize(n);
    solver = SupernodeSolver(supernodes(numbers()));
  }
  std::span<const double> numbers() const { return {static_cast<const double*>(factor->x), factor->xsize}; }
  template <class T>
  Supernodes<T> supernodes(std::span<const T> values) const {
    const std::size_t count = factor->nsuper;
    const auto ints = [](const void* p, std::size_t n) { return std::span(static_cast<const int*>(p), n); };
    return {ints(factor->super, count + 1), ints(factor->pi, count + 1), ints(factor->px, count + 1),
            ints(factor->s, factor->ssize), values};
  }
  /// False where memory does not hold both.
  bool round() {
    if (!rounded.empty()) return true;
    try {
      rounded.reserve(numbers().size());
    } catch (const std::bad_alloc&) {
      return false;
    }
    for (const double number : numbers()) rounded.push_back(static_cast<float>(number));
    return true;
  }
  template <class T>
  void solve(std::span<const T> values, std::span<const double> b, std::span<double> x) {
    for (std::size_t i = 0; i < b.size(); ++i)
      if (place[i] >= 0) ordered[at(place[i])] = b[i];
    solver.solve(supernodes(values), pool, ordered);
    for (std::size_t i = 0; i < b.size(); ++i) x[i] = place[i] >= 0 ? ordered[at(place[i])] : 0.0;
  }
  ~Impl() {
    cholmod_free_dense(&rhs, &common);
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&work_y, &common);
    cholmod_free_dense(&work_e, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
};

BlockCholesky::BlockCholesky(const BlockMatrix& pattern, const DofFilter& filter, Pivots pivots,
                             const EliminationOrder* order, ThreadPool* pool)
    : impl_(std::make_unique<Impl>(pattern, filter, pivots, order, pool)) {}
BlockCholesky::~BlockCholesky() = default;
BlockCholesky::BlockCholesky(BlockCholesky&&) noexcept = default;
BlockCholesky& BlockCholesky::operator=(BlockCholesky&&) noexcept = default;

double BlockCholesky::factor_flops() const { return impl_->common.fl; }

/// The peak of a factorisation, beside what the analysis has left: CHOLMOD holds the matrix in its own order then,
/// and once more while it orders it (cholmod_factorize_p). Supernodes are dense, of which one is updated at a time;
/// else columns have room to grow, by Common->grow1 and grow2.
double BlockCholesky::factor_bytes() const {
  const cholmod_factor& L = *impl_->factor;
  const cholmod_common& c = impl_->common;
  constexpr double number = sizeof(double), entry = sizeof(int) + sizeof(double);
  const auto n = static_cast<double>(L.n);
  const double matrix = entry * static_cast<double>(impl_->matrix.row.size()) + sizeof(int) * n;
  if (L.is_super == 0) return entry * (c.grow1 * c.lnz + static_cast<double>(c.grow2) * n) + matrix + 4 * number * n;
  return number * (static_cast<double>(L.xsize) + 4 * n) + matrix +
         std::max(matrix, number * static_cast<double>(L.maxcsize));
}

bool BlockCholesky::factorize(const BlockMatrix& matrix, double shift, const BlockMatrix* shift_from) {
  Impl& m = *impl_;
  m.matrix.fill(matrix, m.filter, shift, shift_from);
  m.rounded.clear();
  cholmod_factorize(&m.sparse, m.factor, &m.common);
  if (m.common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  return m.common.status == CHOLMOD_OK && m.factor->minor == m.factor->n;
}

int BlockCholesky::negative_pivots() const {
  const cholmod_factor& L = *impl_->factor;
  if (L.is_ll != 0) return 0;
  const auto* begin = static_cast<const int*>(L.p);
  const auto* value = static_cast<const double*>(L.x);  // D stands first in each column
  int count = 0;
  for (std::size_t j = 0; j < L.n; ++j) count += value[begin[j]] < 0 ? 1 : 0;
  return count;
}

void BlockCholesky::solve(std::span<const double> b, std::span<double> x) const {
  Impl& m = *impl_;
  if (m.factor->is_super != 0) return m.solve(m.numbers(), b, x);
  auto* rhs = static_cast<double*>(m.rhs->x);
  for (std::size_t i = 0; i < b.size(); ++i)
    if (m.matrix.number[i] >= 0) rhs[m.matrix.number[i]] = b[i];
  if (cholmod_solve2(CHOLMOD_A, m.factor, m.rhs, nullptr, &m.solution, nullptr, &m.work_y, &m.work_e, &m.common) == 0)
    throw std::bad_alloc();
  const auto* solution = static_cast<const double*>(m.solution->x);
  for (std::size_t i = 0; i < b.size(); ++i) x[i] = m.matrix.number[i] >= 0 ? solution[m.matrix.number[i]] : 0.0;
}

void BlockCholesky::precondition(std::span<const double> b, std::span<double> x) {
  Impl& m = *impl_;
  if (m.factor->is_super == 0 || !m.round()) return solve(b, x);
  m.solve(std::span<const float>(m.rounded), b, x);
}

double BlockCholesky::rounded_bytes() const {
  return impl_->factor->is_super == 0 ? 0.0 : sizeof(float) * static_cast<double>(impl_->factor->xsize);
}

}  // namespace fascia
