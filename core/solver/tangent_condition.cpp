#include "core/solver/tangent_condition.hpp"

#include "core/base/index.hpp"
#include "core/linear/lanczos.hpp"
#include "core/node/small_factor.hpp"
#include "core/solver/mechanical_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

/// The parts of TangentSolver and MechanicalSystem that estimate the condition of a tangent.
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
  work_.resize(at(model_.dof_count()));
  assemble(lin, matrix());
  low_rank_.set(lin.low_rank, filter_);
  if (!order().fits() || order().flops > most_flops) return out;
  solving_ = &factor();
  if (!solving_->factorize(matrix()) && !definite_with_low_rank()) {
    out.kind = TangentCondition::Kind::not_definite;
    return out;
  }
  build_block_jacobi(matrix());
  const DofLayout& dofs = model_.points.dofs;
  std::mt19937 random(1);
  Vector start(at(dofs.total()));
  for (double& x : start) x = 2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0;
  filter_.clear_fixed(start);
  // It is as large in torques as in forces, by what each resists.
  for (int node = 0; node < dofs.node_count(); ++node)
    for (int k = 0, n = dofs.size(node); k < n; ++k)
      start[at(dofs.begin(node) + k)] /= std::sqrt(inverse_blocks_[dofs.block_begin(node) + at(n * k + k)]);
  std::vector<SmallFactor> inverse(at(dofs.node_count()));  // of the inverse blocks
  for (int node = 0; node < dofs.node_count(); ++node)
    inverse[at(node)].factorize(inverse_blocks_.data() + dofs.block_begin(node), dofs.size(node));
  const auto scale = [&](const Vector& r, Vector& v) {
    for (int node = 0; node < dofs.node_count(); ++node) {
      const double* row = inverse_blocks_.data() + dofs.block_begin(node);
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
  out.largest = largest_ratio(start, options, scale, [&](const Vector& v, Vector& w) {
                  apply_matrix(v, w);
                  filter_.clear_fixed(w);
                }).value;
  const auto solve = [&](const Vector& r, Vector& v) { solve_with_factor(r, v); };
  out.smallest = 1 / largest_ratio(start, options, solve, unscale).value;
  const CgOptions asked = settings_.cg;
  const double product = 2.0 * static_cast<double>(matrix().value_count()) * (matrix().fills_upper() ? 2 : 1);
  settings_.cg.max_iterations = std::min(asked.max_iterations, static_cast<int>(kPartOfFlops * most_flops / product));
  Vector x(start.size());
  const TangentReport made = solve_cg(start, x);
  out.cg_iterations = made.iterations;
  out.cg_converged = made.usable && !made.unsolved;
  settings_.cg = asked;
  out.kind = TangentCondition::Kind::known;
  return out;
}

TangentCondition MechanicalSystem::condition(double most_flops) {
  executor_.linearize(state_, history_, settings_.tangent, lin_);
  add_node_blocks(lin_);
  return tangent_.condition(lin_, most_flops);
}

}  // namespace fascia
