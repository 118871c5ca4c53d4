#include "core/linear/elimination_order.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <vector>

namespace fascia {

/// Minimum degree, of the build without SuiteSparse.
EliminationOrder EliminationOrder::of(const BlockMatrix& pattern, const DofFilter& filter, double /*enough*/) {
  using Sparse = Eigen::SparseMatrix<double>;
  const NodeGraph graph(pattern, filter);
  const std::vector<double> ones(graph.row.size(), 1.0);
  const Eigen::Map<const Sparse> lower(graph.size(), graph.size(), static_cast<Eigen::Index>(graph.row.size()),
                                       graph.column_begin.data(), graph.row.data(), ones.data());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(Sparse(lower).selfadjointView<Eigen::Lower>(), permutation);
  const auto& indices = permutation.indices();
  return graph.counted({indices.begin(), indices.end()});
}

}  // namespace fascia
