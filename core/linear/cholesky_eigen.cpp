#include "core/base/errors.hpp"
#include "core/linear/cholesky.hpp"
#include "core/linear/free_matrix.hpp"

#include <Eigen/SparseCholesky>

#include <vector>

namespace fascia {

namespace {

/// Tells how many entries the factor will have, once its pattern is analysed.
template <class Solver>
struct Analysed : Solver {
  double entries() const {
    return this->m_matrix.outerSize() == 0
               ? 0.0
               : static_cast<double>(this->m_matrix.outerIndexPtr()[this->m_matrix.outerSize()]);
  }
  std::vector<int> counts() const { return {this->m_nonZerosPerCol.begin(), this->m_nonZerosPerCol.end()}; }
  std::vector<int> order() const {
    const auto& indices = this->m_Pinv.indices();
    return {indices.begin(), indices.end()};
  }
};

}  // namespace

/// Minimum degree. Factors of this build order single degrees of freedom by themselves.
EliminationOrder EliminationOrder::of(const BlockMatrix& pattern, const DofFilter& filter, double /*enough*/) {
  const NodeGraph graph(pattern, filter);
  const std::vector<double> ones(graph.row.size(), 1.0);
  Analysed<Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower>> analysis;
  analysis.analyzePattern(Eigen::Map<const Eigen::SparseMatrix<double>>(
      graph.size(), graph.size(), static_cast<Eigen::Index>(graph.row.size()), graph.column_begin.data(),
      graph.row.data(), ones.data()));
  std::vector<int> counts = analysis.counts();
  for (int& count : counts) ++count;  // the diagonal, which it leaves out
  return graph.counted(analysis.order(), counts);
}

/// The build without SuiteSparse: slower on large models, same results to rounding.
struct BlockCholesky::Impl {
  using Sparse = Eigen::Map<const Eigen::SparseMatrix<double>>;
  FreeMatrix<int> matrix;
  const DofFilter& filter;
  Analysed<Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower>> llt;
  Analysed<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower>> ldlt;
  bool any_pivots;
  double flops = 0;
  Eigen::VectorXd rhs;

  Impl(const BlockMatrix& pattern, const DofFilter& f, Pivots pivots, const EliminationOrder* order)
      : matrix(pattern, f), filter(f), any_pivots(pivots == Pivots::any), rhs(matrix.size) {
    const EliminationOrder counted = order != nullptr ? *order : EliminationOrder::of(pattern, f);
    if (!counted.narrow())
      throw InputError(
          "out of memory: the factor of the direct solver would have more numbers than the indices of this build "
          "reach, "
          "which was made without CHOLMOD; use solver.linear = { kind = \"cg\" }");
    flops = counted.flops;
    if (any_pivots)
      ldlt.analyzePattern(view());
    else
      llt.analyzePattern(view());
  }
  Sparse view() const {
    return {
        matrix.size,       matrix.size,        static_cast<Eigen::Index>(matrix.row.size()), matrix.column_begin.data(),
        matrix.row.data(), matrix.value.data()};
  }
};

BlockCholesky::BlockCholesky(const BlockMatrix& pattern, const DofFilter& filter, Pivots pivots,
                             const EliminationOrder* order, ThreadPool* /*pool*/)
    : impl_(std::make_unique<Impl>(pattern, filter, pivots, order)) {}
BlockCholesky::~BlockCholesky() = default;
BlockCholesky::BlockCholesky(BlockCholesky&&) noexcept = default;
BlockCholesky& BlockCholesky::operator=(BlockCholesky&&) noexcept = default;

/// The peak of a factorisation: the factor, and the matrix in its order.
double BlockCholesky::factor_bytes() const {
  constexpr double number = sizeof(double), entry = sizeof(int) + sizeof(double);
  const double entries = impl_->any_pivots ? impl_->ldlt.entries() : impl_->llt.entries();
  return entry * (entries + static_cast<double>(impl_->matrix.row.size())) + 3 * number * impl_->matrix.size;
}

double BlockCholesky::factor_flops() const { return impl_->flops; }

bool BlockCholesky::factorize(const BlockMatrix& matrix, double shift, const BlockMatrix* shift_from) {
  Impl& m = *impl_;
  m.matrix.fill(matrix, m.filter, shift, shift_from);
  if (m.any_pivots) {
    m.ldlt.factorize(m.view());
    return m.ldlt.info() == Eigen::Success;
  }
  m.llt.factorize(m.view());
  return m.llt.info() == Eigen::Success;
}

int BlockCholesky::negative_pivots() const {
  return impl_->any_pivots ? static_cast<int>((impl_->ldlt.vectorD().array() < 0).count()) : 0;
}

void BlockCholesky::solve(std::span<const double> b, std::span<double> x) const {
  Impl& m = *impl_;
  for (std::size_t i = 0; i < b.size(); ++i)
    if (m.matrix.number[i] >= 0) m.rhs[m.matrix.number[i]] = b[i];
  Eigen::VectorXd solution;
  if (m.any_pivots)
    solution = m.ldlt.solve(m.rhs);
  else
    solution = m.llt.solve(m.rhs);
  for (std::size_t i = 0; i < b.size(); ++i) x[i] = m.matrix.number[i] >= 0 ? solution[m.matrix.number[i]] : 0.0;
}

void BlockCholesky::precondition(std::span<const double> b, std::span<double> x) { solve(b, x); }

double BlockCholesky::rounded_bytes() const { return 0; }

}  // namespace fascia
