#include "core/solver/boundary_motion.hpp"
#include "core/solver/mechanical_system.hpp"

#include <algorithm>
#include <cmath>

/// The parts of TangentSolver and MechanicalSystem that path following needs.
namespace fascia {

std::optional<int> TangentSolver::factorize_as_is(const Linearization& lin) {
  if (filter_.free_count() == 0) return 0;
  assemble(lin, matrix());
  // Cholesky, which is several times faster, while it lasts.
  as_is_ = unstable_ > 0 ? nullptr : &factor();
  if (as_is_ != nullptr && as_is_->factorize(matrix())) return 0;
  const std::optional<int> negative = factorize_any();
  as_is_ = &*indefinite_;
  if (negative) unstable_ = *negative;
  if (!negative || lin.symmetric()) return negative;
  solving_ = as_is_;
  const SoftestDirection whole = softest_unsymmetric(lin, false);
  return whole.probe.usable ? std::optional(whole.probe.unstable) : std::nullopt;
}

bool TangentSolver::solve_as_is(const Linearization& lin, std::span<const double> prescribed, std::span<const double> b,
                                std::span<double> x) {
  const std::size_t n = b.size();
  if (filter_.free_count() == 0) {
    std::copy(prescribed.begin(), prescribed.end(), x.begin());
    return true;
  }
  work_.resize(n);
  solution_.resize(n);
  rhs_.assign(b.begin(), b.end());
  if (!lin.symmetric()) {
    apply_unsymmetric(lin, prescribed, solution_);
    for (std::size_t i = 0; i < n; ++i) rhs_[i] -= solution_[i];
    filter_.clear_fixed(rhs_);
    solving_ = as_is_;
    const bool solved = solve_whole(lin, rhs_, x, kDirectTolerance, nullptr);
    take_prescribed(prescribed, x);
    return solved;
  }
  apply_matrix(prescribed, solution_);
  for (std::size_t i = 0; i < n; ++i) rhs_[i] -= solution_[i];
  filter_.clear_fixed(rhs_);
  as_is_->solve(rhs_, x);
  // No pivoting: one step of refinement, which also tells how good the solution is.
  apply_matrix(x, solution_);
  for (std::size_t i = 0; i < n; ++i) rhs_[i] -= solution_[i];
  filter_.clear_fixed(rhs_);
  as_is_->solve(rhs_, solution_);
  constexpr double kSpoilt = 1e-2;
  double squared = 0, change = 0;
  for (std::size_t i = 0; i < n; ++i) {
    squared += x[i] * x[i];
    change += solution_[i] * solution_[i];
    x[i] += solution_[i];
    if (filter_.is_fixed(i)) x[i] = prescribed[i];
  }
  return std::isfinite(squared) && std::sqrt(change) <= kSpoilt * std::sqrt(squared);
}

double MechanicalSystem::largest_rotation_in(std::span<const double> vector) const {
  double largest = 0;
  const DofLayout& dofs = model_.points.dofs;
  for (int node = 0; node < model_.node_count(); ++node)
    largest = std::max(largest, rotation_in(dofs.kind(node), vector.data() + dofs.begin(node)));
  return largest;
}

PathDirections MechanicalSystem::path_directions(std::span<const double> ahead, std::span<const double> behind,
                                                 double width) {
  PathDirections out;
  executor_.linearize(state_, history_, settings_.tangent, lin_);
  add_node_blocks(lin_);
  const std::optional<int> unstable = tangent_.factorize_as_is(lin_);
  if (!unstable) return out;
  out.unstable = *unstable;
  const std::size_t n = gradient_.size();
  std::vector<double> rhs(n), prescribed(n), other(n);
  out.d_r.resize(n);
  out.d_f.resize(n);
  for (std::size_t i = 0; i < n; ++i) rhs[i] = -gradient_[i];
  filter_.to_local(rhs);
  prescribed_increments(model_, filter_, state_, increment_.turned, factors_, prescribed);
  out.usable = tangent_.solve_as_is(lin_, prescribed, rhs, out.d_r);

  // Loads are linear in their factors: −∂r/∂λ is the load of the factors' slopes.
  const std::vector<double> present = factors_;
  for (std::size_t k = 0; k < present.size(); ++k) factors_[k] = (ahead[k] - behind[k]) / width;
  add_loads();
  rhs = load_;
  factors_ = present;
  add_loads();
  const bool moving_tethers =
      std::any_of(model_.tethers.begin(), model_.tethers.end(), [](const Tether& t) { return t.motion >= 0; });
  if (moving_tethers) {
    for (const auto& [factors, sign] : {std::pair{ahead, -1.0}, std::pair{behind, 1.0}}) {
      place_tethers(model_, factors, executor_.targets());
      executor_.forces(state_, history_, other);
      for (std::size_t i = 0; i < n; ++i) rhs[i] += sign * other[i] / width;
    }
    place_tethers(model_, factors_, executor_.targets());
  }
  dependents_.transfer(rhs);
  filter_.to_local(rhs);
  prescribed_increments(model_, filter_, state_, increment_.turned, ahead, prescribed);
  prescribed_increments(model_, filter_, state_, increment_.turned, behind, other);
  for (std::size_t i = 0; i < n; ++i) prescribed[i] = (prescribed[i] - other[i]) / width;
  out.usable = tangent_.solve_as_is(lin_, prescribed, rhs, out.d_f) && out.usable;
  filter_.to_global(out.d_r);
  filter_.to_global(out.d_f);
  dependents_.expand(out.d_r);
  dependents_.expand(out.d_f);
  out.largest_rotation = largest_rotation_in(out.d_f);
  return out;
}

void MechanicalSystem::keep_loads() {
  kept_loads_.resize(part_squares_.load.size(), 0.0);
  for (std::size_t p = 0; p < kept_loads_.size(); ++p) kept_loads_[p] = std::max(kept_loads_[p], part_squares_.load[p]);
}

double MechanicalSystem::steer(const PathDirections& directions, double weight, double rate) {
  for (std::size_t i = 0; i < direction_.size(); ++i)
    direction_[i] = weight * directions.d_r[i] + rate * directions.d_f[i];
  return largest_rotation_in(direction_);
}

}  // namespace fascia
