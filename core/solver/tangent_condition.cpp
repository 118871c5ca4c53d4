#include "core/solver/tangent_condition.hpp"
#include "core/math/index.hpp"
#include "core/solver/lanczos.hpp"
#include "core/solver/mechanical_system.hpp"
#include "core/solver/positive_inverse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

/// The parts of TangentSolver and MechanicalSystem that estimate the condition of a tangent.
namespace fascia {

namespace {

using Vector = std::vector<double>;

/// Large eigenvalues need not be known well: their root counts.
constexpr LanczosOptions kLooks{100, 5, 3e-3};

}  // namespace

double TangentCondition::cg_iterations(double tolerance) const {
  return 0.5 * std::sqrt(ratio()) * std::log(2 / tolerance);
}

double TangentCondition::digits() const {
  return std::max(0.0, -std::log10(std::numeric_limits<double>::epsilon() * ratio()));
}

TangentCondition TangentSolver::condition(const Linearization& lin, double most_flops) {
  TangentCondition out;
  if (filter_.free_count() == 0) return out;
  work_.resize(at(model_.dof_count()));
  assemble(lin, matrix());
  low_rank_.set(lin.low_rank, filter_);
  if (factor().factor_flops() > most_flops) return out;
  solving_ = &factor();
  if (!solving_->factorize(matrix()) && !definite_with_low_rank()) {
    out.kind = TangentCondition::Kind::not_definite;
    return out;
  }
  build_block_jacobi();
  const DofLayout& dofs = model_.points.dofs;
  std::mt19937 random(1);
  Vector start(at(dofs.total()));
  for (double& x : start) x = 2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0;
  filter_.clear_fixed(start);
  const auto by_blocks = [&](const Vector& blocks, const Vector& x, Vector& y) {
    for (int node = 0; node < dofs.node_count(); ++node)
      for (int i = 0; i < dofs.size(node); ++i) {
        const double* row = blocks.data() + dofs.block_begin(node) + at(dofs.size(node) * i);
        double sum = 0;
        for (int j = 0; j < dofs.size(node); ++j) sum += row[j] * x[at(dofs.begin(node) + j)];
        y[at(dofs.begin(node) + i)] = sum;
      }
    filter_.clear_fixed(y);
  };
  LanczosOptions options = kLooks;
  options.most = std::min(options.most, filter_.free_count());
  out.largest = largest_ratio(
                    start, options, [&](const Vector& r, Vector& v) { by_blocks(inverse_blocks_, r, v); },
                    [&](const Vector& v, Vector& w) {
                      apply_matrix(v, w);
                      filter_.clear_fixed(w);
                    })
                    .value;
  Vector blocks = std::move(inverse_blocks_);
  for (int node = 0; node < dofs.node_count(); ++node)
    positive_inverse(blocks.data() + dofs.block_begin(node), dofs.size(node));
  const double softest = largest_ratio(
                             start, options, [&](const Vector& r, Vector& v) { solve_with_factor(r, v); },
                             [&](const Vector& v, Vector& w) { by_blocks(blocks, v, w); })
                             .value;
  out.smallest = 1 / softest;
  out.kind = TangentCondition::Kind::known;
  return out;
}

TangentCondition MechanicalSystem::condition(double most_flops) {
  executor_.linearize(state_, history_, settings_.tangent, lin_);
  add_node_blocks(lin_);
  return tangent_.condition(lin_, most_flops);
}

}  // namespace fascia
