#pragma once

#include "core/base/clock.hpp"
#include "core/step/boundary_loops.hpp"
#include "gpu/system/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

/// Newton's directions of System.
namespace fascia::gpu {

template <class Space>
template <class T, class V>
kernels::ProductView<T, V> System<Space>::product_view() {
  kernels::ProductView<T, V> w;
  w.m = data_.view();
  w.Q = Q_.data();
  w.y = world_y_.data();
  if constexpr (std::is_same_v<V, double>) {
    w.node_blocks = node_blocks_.data();
    w.d = world_d_.data();
    w.dx = dx_.data();
  } else {
    w.node_blocks = narrow_blocks_.data();
    w.d = narrow_d_.data();
    w.dx = narrow_dx_.data();
  }
  if constexpr (std::is_same_v<T, double>)
    w.dA = dA_.data();
  else
    w.dA = narrow_dA_.data();
  return w;
}

template <class Space>
void System<Space>::linearize(Tangent tangent, bool tethers_turn, const TakenStepView& taken) {
  const NodesView& nodes = data_.view().nodes;
  tangent_ = tangent;
  const Mat3d* L = linearize_blocks(tangent, taken);
  const Mat3d* taken_off = tethers_turn ? nullptr : tether_L_.data();
  Space::for_each(nodes.count, kernels::NodeBlocks{step_view(), L, taken_off, Q_.data(), node_blocks_.data(),
                                                   tangent == Tangent::full});
  if (use_tiles()) {
    linearize_tiles(tangent);
    return;
  }
  blocks_.add_spring_blocks(nodes, pose(), tangent, node_blocks_.data());
  if (!dependents_.empty() && tangent == Tangent::full && tethers_turn)
    dependents_.add_turning(nodes, dependent_forces_.data(), node_blocks_.data());
  if (!moving_.surfaces.empty()) {
    moving_.surfaces.linearize(nodes, Q_.data(), data_.view().factors, tangent, surface_tangent_, node_blocks_.data());
    for (int t = 0; t < moving_.surfaces.terms() && !dependents_.empty(); ++t)
      dependents_.transfer(nodes, surface_tangent_.volume_gradient(t));
  }
  inverse_.copy_from(node_blocks_);
  const PreconditionerKind kind = settings_.preconditioner;
  if (kind != PreconditionerKind::none) blocks_.add_diagonal(nodes, Q_.data(), inverse_.data());
  if (!dependents_.empty()) dependents_.add_diagonal(nodes, inverse_.data());
  Space::for_each(nodes.count, kernels::InvertBlocks{data_.view(), inverse_.data(), kind == PreconditionerKind::jacobi,
                                                     kind == PreconditionerKind::none});
  if (settings_.precision != Precision::single) return;
  const int entries = static_cast<int>(node_blocks_.size());
  Space::for_each(entries, kernels::Round<float>{node_blocks_.data(), narrow_blocks_.data()});
  Space::for_each(entries, kernels::Round<float>{inverse_.data(), narrow_inverse_.data()});
}

/// The step that led to the present state, as note_direction() and apply() left it: good until the next product.
template <class Space>
TakenStepView System<Space>::taken_step() const {
  if (taken_length_ == 0) return {};
  return {{taken_.u.data(), taken_.D.data()}, {world_d_.data(), dx_.data(), dA_.data()}, taken_length_};
}

/// All but springs. Tiles take the stresses of the state. @return  N Qᵀ of frames with the tangent's stresses
template <class Space>
const Mat3d* System<Space>::linearize_blocks(Tangent tangent, const TakenStepView& taken) {
  if (use_tiles()) return L_.data();
  blocks_.linearize(pose(), history(), tangent, taken);
  if (!taken.known() || !turning_ || blocks_.points().empty()) return L_.data();
  extrapolated_L_.resize(L_.size());
  Space::for_each(model_.node_count(),
                  kernels::ExtrapolatedMoments{step_view(), blocks_.points().view(), extrapolated_L_.data()});
  return extrapolated_L_.data();
}

template <class Space>
void System<Space>::linearize_tiles(Tangent tangent) {
  blocks_.add_spring_blocks(data_.view().nodes, pose(), tangent, node_blocks_.data());
  tiles_->linearize(now_.u.data()->v, &(*now_.D.data())(0, 0), tangent, history().inverse_step);
  tiles_->set_node_blocks(node_blocks_.data());
  if (settings_.preconditioner != PreconditionerKind::none) tiles_->build_preconditioner();
}

/// v.Ap = K v.p in constraint axes, with the next direction in v.p.
template <class Space>
template <class T, class V>
void System<Space>::apply_tangent(const CgView<V>& v) {
  const kernels::ProductView<T, V> w = product_view<T, V>();
  const int n = w.m.nodes.count;
  const kernels::FinishProduct<V> finish{w.m, v, w.y};
  if (dependents_.empty() && moving_.surfaces.empty()) {
    Space::for_each(n, kernels::NextDirection<T, V, V>{w, v});
    blocks_.template product<T, V>(w.direction());
    const kernels::GatherProduct<T, V> gather{w, blocks_.template view_of<T>()};
    Space::template sum<1>(n, kernels::GatherAndFinish<T, V, V>{gather, finish}, kernels::TakeCurvature<V>{v});
    return;
  }
  Space::for_each(n, kernels::NextDirection<double, double, V>{product_view<double, double>(), v});
  multiply(w);
  gather_product(w);
  Space::template sum<1>(n, finish, kernels::TakeCurvature<V>{v});
}

/// Product of the blocks with the direction in world axes, of 64 bits, and with what depends on it.
template <class Space>
template <class T, class V>
void System<Space>::multiply(const kernels::ProductView<T, V>& w) {
  const kernels::ProductView<double, double> from = product_view<double, double>();
  if (!dependents_.empty()) dependents_.expand(w.m.nodes, from.d, from.dx, from.dA, w.Q);
  if constexpr (!std::is_same_v<T, double>) Space::for_each(w.m.nodes.count, kernels::RoundDirection<T, V>{from, w});
  blocks_.template product<T, V>(w.direction());
}

template <class Space>
template <class T, class V>
void System<Space>::gather_product(const kernels::ProductView<T, V>& w) {
  const DirectionView direction = product_view<double, double>().direction();
  Space::for_each(w.m.nodes.count, kernels::GatherProduct<T, V>{w, blocks_.template view_of<T>()});
  if (!moving_.surfaces.empty()) moving_.surfaces.add_product(surface_tangent_, w.m.nodes, w.Q, direction.d, w.y);
  if (!dependents_.empty()) dependents_.transfer(w.m.nodes, w.y, nullptr);
  if (!moving_.surfaces.empty()) moving_.surfaces.add_volume_product(surface_tangent_, direction.d, w.y);
}

/// Another one wherever the loops of a product must be recorded anew.
template <class Space>
std::uint64_t System<Space>::operator_key() {
  const Operator now{history_.inverse_step, tangent_, blocks_.elements().extrapolated(), levels_.key()};
  if (now != operator_) ++operator_count_;
  operator_ = now;
  return operator_count_;
}

/// CG in tiles. The report's norm of what is left of the right-hand side is not what tiles judge by: it takes one more
/// product.
template <class Space>
CgReport System<Space>::solve_in_tiles(const CgOptions& options) {
  CgReport report = tiles_->solve(cg_.rhs(), cg_.solution(), options);
  tiles_->multiply(cg_.solution(), world_y_.data());
  Space::template sum<2>(model_.dof_count(), kernels::LinearResidual{cg_.rhs(), world_y_.data()},
                         loops::StoreSums<2, 0>{slope_.data()});
  double squares[3];
  slope_.download(squares);
  if (squares[1] > 0) report.relative_norm = std::sqrt(squares[0] / squares[1]);
  return report;
}

/// @param has_material  levels of the tangent's material part may take the place of those of an indefinite one
template <class Space>
CgReport System<Space>::solve(const CgOptions& options, bool has_material) {
  if (!use_levels()) return solve_by_blocks(options);
  const int made = kept_levels_.made();
  const CgReport cg = solve_by_levels(options, has_material);
  // There is no way back to tiles, nor from a look at the tangent alone.
  if (has_material && blocks_or_levels_.levels() && tiles_ == nullptr)
    blocks_or_levels_.took(cg.iterations, kept_levels_.made() - made);
  return cg;
}

template <class Space>
CgReport System<Space>::solve_by_blocks(const CgOptions& options) {
  if (use_tiles()) return solve_in_tiles(options);
  return with_scalars([&]<class T, class V>() {
    const V* inverse = nullptr;
    if constexpr (std::is_same_v<V, double>)
      inverse = inverse_.data();
    else
      inverse = narrow_inverse_.data();
    return solver<V>().solve(data_.view().nodes, inverse, options, operator_key(),
                             [&](const CgView<V>& v) { apply_tangent<T, V>(v); });
  });
}

/// A limit that nobody set is no reason to stop; the time that a step has is one.
template <class Space>
CgOptions System<Space>::solve_options() const {
  CgOptions options = settings_.cg;
  if (limit_is_guessed()) options.max_iterations *= kPatience;
  options.timed = most_iterations_ < options.max_iterations;
  options.max_iterations = std::min(options.max_iterations, most_iterations_);
  return options;
}

/// The softest direction of the full tangent at the present state, which was evaluated.
template <class Space>
SoftestDirection System<Space>::softest() {
  linearize(Tangent::full, true);
  most_iterations_ = kAsManyAsNeeded;
  const CgOptions options = solve_options();
  const auto probe = [&](std::span<const double> b, std::span<double> x) {
    return with_scalars([&]<class T, class V>() {
      std::vector<V> vector(b.begin(), b.end());
      Space::copy_in(solver<V>().rhs(), vector.data(), vector.size() * sizeof(V));
      const CgReport cg = solve(options, false);
      Space::copy_out(vector.data(), solver<V>().solution(), vector.size() * sizeof(V));
      std::copy(vector.begin(), vector.end(), x.begin());
      const bool met = cg.status == CgStatus::negative_curvature;
      return TangentProbe{met || cg.status == CgStatus::converged, met ? 1 : 0};
    });
  };
  SoftestDirection found = softest_direction(model_, filter_, probe, 1);
  if (!conservative_ && found.probe.unstable > 0) return {};  // of the symmetric part alone: nothing is known
  // A solve that was cut short has no quotient, and must not pass for one near a limit point.
  if (found.probe.unstable > 0) found.stiffness = -std::numeric_limits<double>::infinity();
  return found;
}

/// still_Ap_ = K p in constraint axes, beside whatever solve is under way.
template <class Space>
void System<Space>::product_at_rest(double* p) {
  const auto n = static_cast<std::size_t>(model_.dof_count());
  still_.resize(n);
  still_Ap_.resize(n);
  still_.set_zero();
  idle_.set_zero();
  const CgView<double> v{nullptr, nullptr, p, still_.data(), still_Ap_.data(), idle_.data()};
  if (use_tiles())
    tiles_->multiply(p, still_Ap_.data());
  else if (settings_.precision == Precision::full)
    apply_tangent<double, double>(v);
  else
    apply_tangent<float, double>(v);
}

template <class Space>
DirectionReport System<Space>::direction(int most_iterations) {
  most_iterations_ = kAsManyAsNeeded;
  if (most_iterations < solve_options().max_iterations) most_iterations_ = most_iterations;
  const bool whole = unsymmetric();
  if (indefinite_ || too_slow_ || (whole && host_may_solve())) return direction_of_host();
  if (blocks_or_levels_.levels() && (kept_levels_.fail() || !levels_fit_)) blocks_or_levels_.turn_to_blocks();
  linearize(settings_.tangent, true, taken_step());
  const int n = model_.node_count();
  const auto right_hand_side = [&] {
    if (prescribed_left_) product_at_rest(prescribed_.data());
    const double* moved = prescribed_left_ ? still_Ap_.data() : nullptr;
    with_scalars([&]<class T, class V>() {
      Space::for_each(n, kernels::RightHandSide<V>{data_.view(), gradient_.data(), moved, solver<V>().rhs()});
    });
  };
  const Clock::time_point start = Clock::now();
  const auto solved = [&](const CgOptions& options) {
    right_hand_side();
    if (whole) {
      if (const std::optional<CgReport> exact = solve_unsymmetric(options)) return *exact;
      right_hand_side();
    }
    return solve(options);
  };
  const auto solved_by_either = [&](bool tethers_turn) {
    if (!levels_may_pay()) return solved(solve_options());
    const CgReport tried = solved(before_levels());
    if (tried.status != CgStatus::limit) return tried;
    const bool in_tiles = use_tiles();
    blocks_or_levels_.turn_to_levels();
    if (in_tiles) linearize(settings_.tangent, tethers_turn);
    CgReport cg = solved(solve_options());
    cg.iterations += tried.iterations;
    return cg;
  };
  CgReport cg = solved_by_either(true);
  const bool failed = cg.status == CgStatus::negative_curvature || cg.status == CgStatus::limit;
  if (most_iterations_ == kAsManyAsNeeded && host_is_faster(cg.iterations)) too_slow_ = true;
  if ((too_slow_ || cg.status == CgStatus::negative_curvature) && failed && host_may_solve()) {
    DirectionReport report = direction_of_host();
    report.linear_iterations += cg.iterations;
    return report;
  }
  if (cg.status == CgStatus::negative_curvature && !model_.tethers.empty()) {
    linearize(settings_.tangent, false);
    cg = solved_by_either(false);
  }
  DirectionReport report;
  report.cg_seconds = seconds_since(start);
  report.linear_residual = cg.relative_norm;
  report.linear_iterations = cg.iterations;
  report.unsolved = cg.status == CgStatus::limit;
  if (cg.status == CgStatus::negative_curvature) report.trouble = "CG met negative curvature";
  if (cg.status == CgStatus::not_finite) {
    report.usable = false;
    report.trouble = "CG met a number that is not finite";
    return report;
  }
  with_scalars([&]<class T, class V>() {
    const double* prescribed = prescribed_left_ ? prescribed_.data() : nullptr;
    Space::template sum<1, 2>(
        n,
        loops::TakeDirection<V>{data_.view(), solver<V>().solution(), prescribed, gradient_.data(), direction_.data()},
        loops::StoreSums<1, 2>{slope_.data()});
  });
  if (!dependents_.empty()) dependents_.expand(data_.view().nodes, direction_.data(), nullptr, nullptr, Q_.data());
  if (!moving_.surfaces.empty()) moving_.surfaces.aim(surface_tangent_, direction_.data());
  double values[3];
  slope_.download(values);
  report.slope = values[0];
  report.largest_rotation = std::max(values[1], note_direction());
  report.usable = std::isfinite(values[2]);
  if (!report.usable) report.trouble = "the linear solver returned a number that is not finite";
  return report;
}

/// Keeps the motion of the direction by nodes. @return  its largest rotation in elements [rad]
template <class Space>
double System<Space>::note_direction() {
  if (use_tiles()) return 0;
  world_d_.copy_from(direction_);
  Space::for_each(model_.node_count(), kernels::SplitDirection{product_view<double, double>()});
  if (blocks_.elements().empty()) return 0;
  blocks_.elements().largest_spin(dx_.data(), spin_.data());
  double spin = 0;
  spin_.download(std::span(&spin, 1));
  return spin;
}

template <class Space>
std::vector<double> System<Space>::product(std::span<const double> d) {
  linearize(settings_.tangent, true);
  if (use_tiles()) {
    world_d_.upload(d);
    tiles_->set_held({});
    tiles_->multiply(world_d_.data(), world_y_.data());
    tiles_->set_held(held_);
    return world_y_.downloaded();
  }
  const NodesView& nodes = data_.view().nodes;
  world_d_.upload(d);
  Space::for_each(nodes.count, kernels::SplitDirection{product_view<double, double>()});
  with_scalars([&]<class T, class V>() {
    const kernels::ProductView<T, V> w = product_view<T, V>();
    multiply(w);
    gather_product(w);
  });
  return world_y_.downloaded();
}

}  // namespace fascia::gpu
