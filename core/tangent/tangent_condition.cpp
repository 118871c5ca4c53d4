#include "core/tangent/tangent_condition.hpp"

#include "core/base/index.hpp"
#include "core/linear/lanczos.hpp"
#include "core/node/small_factor.hpp"
#include "core/tangent/tangent_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace fascia {

namespace {

using Vector = std::vector<double>;

/// Large eigenvalues need not be known well: their root counts.
constexpr LanczosOptions kLooks{200, 5, 1e-3};
/// Products wait for memory: so many operations of them take as long as a factor.
constexpr double kPartOfFlops = 0.3;

}  // namespace

double TangentCondition::digits() const {
  return std::max(0.0, -std::log10(std::numeric_limits<double>::epsilon() * ratio()));
}

TangentCondition TangentSolver::condition(const Linearization& lin, double most_flops) {
  TangentCondition out;
  if (filter_.free_count() == 0) return out;
  K_.take(lin);
  if (factor_.takes_more_than(most_flops) || !factor_.order().moderate()) return out;
  if (!factor_.prepare()) {
    out.kind = TangentCondition::Kind::not_definite;
    return out;
  }
  std::vector<double> inverse_blocks;
  K_.invert_diagonal(K_.matrix(), settings_.preconditioner != PreconditionerKind::jacobi, inverse_blocks);
  const DofLayout& dofs = K_.model().points.dofs;
  std::mt19937 random(1);
  Vector start(at(dofs.total()));
  for (double& x : start) x = 2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0;
  filter_.clear_fixed(start);
  // It is as large in torques as in forces, by what each resists.
  for (int node = 0; node < dofs.node_count(); ++node)
    for (int k = 0, n = dofs.size(node); k < n; ++k)
      start[at(dofs.begin(node) + k)] /= std::sqrt(inverse_blocks[dofs.block_begin(node) + at(n * k + k)]);
  std::vector<SmallFactor> inverse(at(dofs.node_count()));  // of the inverse blocks
  for (int node = 0; node < dofs.node_count(); ++node)
    inverse[at(node)].factorize(inverse_blocks.data() + dofs.block_begin(node), dofs.size(node));
  const auto scale = [&](const Vector& r, Vector& v) {
    for (int node = 0; node < dofs.node_count(); ++node) {
      const double* row = inverse_blocks.data() + dofs.block_begin(node);
      for (int i = dofs.begin(node); i < dofs.begin(node + 1); ++i, row += dofs.size(node))
        v[at(i)] = std::inner_product(row, row + dofs.size(node), r.begin() + dofs.begin(node), 0.0);
    }
  };
  const auto unscale = [&](const Vector& v, Vector& r) {
    r = v;
    for (int node = 0; node < dofs.node_count(); ++node) inverse[at(node)].solve(r.data() + dofs.begin(node));
    filter_.clear_fixed(r);
  };
  LanczosOptions options = kLooks;
  options.most = std::min(options.most, filter_.free_count());
  out.largest = largest_ratio(start, options, scale, [&](const Vector& v, Vector& w) { K_.apply_free(v, w); }).value;
  const auto solve = [&](const Vector& r, Vector& v) { factor_.solve(r, v); };
  out.smallest = 1 / largest_ratio(start, options, solve, unscale).value;
  const double product = 2.0 * static_cast<double>(K_.matrix().value_count()) * (K_.matrix().fills_upper() ? 2 : 1);
  CgOptions few = settings_.cg;
  few.max_iterations = std::min(few.max_iterations, static_cast<int>(kPartOfFlops * most_flops / product));
  Vector x(start.size());
  cg_.prepare();
  cg_.take_exact_products(true);
  const LinearReport made = cg_.solve(start, x, few);
  cg_.take_exact_products(false);
  out.cg_iterations = made.iterations;
  out.with_levels = cg_.levels() != nullptr;
  out.cg_converged = made.usable && !made.unsolved;
  out.kind = TangentCondition::Kind::known;
  return out;
}

}  // namespace fascia
