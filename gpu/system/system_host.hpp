#pragma once

#include "core/linear/gmres.hpp"
#include "gpu/system/system.hpp"

#include <algorithm>

/// Newton's directions of System that the host solves.
namespace fascia::gpu {

/// Conjugate gradients stop at the first direction of negative curvature, and many such steps lead nowhere. Where a
/// factorisation takes seconds at most, the host's, with its shifts, gives the direction instead; not where the user
/// asked for conjugate gradients or set their limit.
template <class Space>
bool System<Space>::host_may_solve() const {
  const bool fluids = std::any_of(model_.surfaces.begin(), model_.surfaces.end(),
                                  [](const SurfaceLoad& s) { return s.bulk_modulus > 0; });
  return limit_is_guessed() && model_.free_dof_count() <= kMostOfFactor && !fluids;
}

/// The tangent of loads without a potential is unsymmetric, which matters in statics; in dynamics inertia makes little
/// of what conjugate gradients leave out.
template <class Space>
bool System<Space>::unsymmetric() const {
  return !conservative_ && step_.h <= 0 && settings_.tangent == Tangent::full;
}

/// GMRES with what the host adds to products, preconditioned by conjugate gradients with the symmetric part. What they
/// had in rhs() becomes what they have in solution(). None where too much is left, as when they meet negative
/// curvature.
template <class Space>
std::optional<CgReport> System<Space>::solve_unsymmetric(const CgOptions& asked) {
  MechanicalSystem& loads = host();
  loads.stand_in(step_in_progress());
  loads.linearize_loads();
  const auto n = static_cast<std::size_t>(model_.dof_count());
  std::vector<double> b(n), x;
  with_scalars([&]<class T, class V>() {
    std::vector<V> rhs(n);
    Space::copy_out(rhs.data(), solver<V>().rhs(), n * sizeof(V));
    std::copy(rhs.begin(), rhs.end(), b.begin());
  });
  if (prescribed_left_) {
    std::vector<double> moved(n);
    loads.add_unsymmetric(prescribed_.downloaded(), moved);
    filter_.clear_fixed(moved);
    for (std::size_t i = 0; i < n; ++i) b[i] -= moved[i];
  }
  CgOptions inner = asked;
  inner.tolerance = std::max(asked.tolerance, kInnerTolerance);
  CgReport report;
  const auto precondition = [&](const std::vector<double>& r, std::vector<double>& z) {
    with_scalars([&]<class T, class V>() {
      std::vector<V> vector(r.begin(), r.end());
      Space::copy_in(solver<V>().rhs(), vector.data(), n * sizeof(V));
      const CgReport cg = solve(inner);
      Space::copy_out(vector.data(), solver<V>().solution(), n * sizeof(V));
      std::copy(vector.begin(), vector.end(), z.begin());
      report.status = cg.status;
      report.iterations += cg.iterations;
    });
    return report.status == CgStatus::converged;
  };
  const auto apply = [&](const std::vector<double>& z, std::vector<double>& w) {
    asked_.upload(z);
    product_at_rest(asked_.data());
    w = still_Ap_.downloaded();
    loads.add_unsymmetric(z, w);
    filter_.clear_fixed(w);
  };
  GmresOptions options;
  options.tolerance = asked.tolerance;
  const GmresReport gmres = gmres_by_length(CpuVectors(loads.executor().pool()), motion_lengths(model_, filter_), apply,
                                            precondition, b, x, options);
  if (!gmres.converged && !(gmres.relative_residual <= kUsefulResidual)) return std::nullopt;
  report.relative_norm = gmres.relative_residual;
  report.status = gmres.converged ? CgStatus::converged : CgStatus::limit;
  with_scalars([&]<class T, class V>() {
    const std::vector<V> solution(x.begin(), x.end());
    Space::copy_in(solver<V>().solution(), solution.data(), n * sizeof(V));
  });
  return report;
}

/// So many iterations take more than twice as long as the host, assembly and factorisation. Counts tell, not clocks,
/// which would make runs differ.
template <class Space>
bool System<Space>::host_is_faster(int iterations) {
  constexpr double kInTiles = 2e-5, kIteration = 5e-5, kUnknown = 3e-6, kOperation = 2e-10;  // seconds each
  if (too_slow_ || !host_may_solve() || use_levels()) return false;
  const double iterating = (use_tiles() ? kInTiles : kIteration) * iterations,
               assembling = kUnknown * model_.free_dof_count();
  if (iterating <= 2 * assembling) return false;  // nor where all is prescribed, and there is nothing to solve
  return !host().linear().factor().takes_more_than((0.5 * iterating - assembling) / kOperation);
}

template <class Space>
MechanicalSystem& System<Space>::host() {
  if (!host_) {
    SolverSettings settings = settings_;
    settings.linear = LinearMethod::cholesky;
    host_ = std::make_unique<HostSystem>(model_, settings);
  }
  return host_->system;
}

template <class Space>
StepInProgress System<Space>::step_in_progress() const {
  StepInProgress out;
  out.start = out.increment = State::at_rest(model_);
  start_.download(out.start);
  increment_.download(out.increment);
  out.step = step_;
  if (step_.scheme != TimeScheme::implicit_euler) {
    out.q = q_.downloaded();
    out.w = w_.downloaded();
  }
  out.history = strain_history();
  out.factors = factors_;
  if (!moving_.surfaces.empty()) out.pressures = moving_.surfaces.followed();
  if (taken_length_ == 0) return out;
  out.taken.u = taken_.u.downloaded();
  out.taken.D = out.start.D;
  if (turning_) taken_.D.download(std::span(&*out.taken.D.begin(), taken_.D.size()));
  out.taken.d = direction_.downloaded();
  for (double& d : out.taken.d) d *= taken_length_;
  return out;
}

template <class Space>
State System<Space>::state() const {
  State present = State::at_rest(model_);
  start_.download(present);
  if (memory_.acts()) present.factors = factors_;
  now_.u.download(present.u);
  if (turning_) now_.D.download(std::span(&*present.D.begin(), now_.D.size()));
  return present;
}

template <class Space>
DirectionReport System<Space>::direction_of_host() {
  MechanicalSystem& solver = host();
  solver.stand_in(step_in_progress());
  DirectionReport report = solver.direction();  // by a factor, which has no iterations to limit
  indefinite_ = !report.trouble.empty();
  direction_.upload(solver.last_direction());
  note_direction();
  return report;
}

}  // namespace fascia::gpu
