#pragma once

#include "gpu/boundary_kernels.hpp"
#include "gpu/system.hpp"

#include <cmath>
#include <cstring>

/// Newton's directions of System.
namespace fascia::gpu {

template <class Space>
kernels::ProductView System<Space>::product_view() {
  return {data_.view(), Q_.data(), node_blocks_.data(), world_d_.data(), world_y_.data(), dx_.data(), dA_.data()};
}

template <class Space>
void System<Space>::linearize(Tangent tangent, bool tethers_turn) {
  const NodesView& nodes = data_.view().nodes;
  tangent_ = tangent;
  const Mat3d* taken_off = tethers_turn ? nullptr : tether_L_.data();
  Space::for_each(nodes.count, kernels::NodeBlocks{step_view(), L_.data(), taken_off, Q_.data(), node_blocks_.data(),
                                                   tangent == Tangent::full});
  blocks_.linearize(nodes, pose(), history(), tangent, node_blocks_.data());
  if (!dependents_.empty() && tangent == Tangent::full && tethers_turn)
    dependents_.add_turning(nodes, dependent_forces_.data(), node_blocks_.data());
  inverse_.copy_from(node_blocks_);
  const Preconditioner kind = settings_.preconditioner;
  if (kind != Preconditioner::none) blocks_.add_diagonal(nodes, Q_.data(), inverse_.data());
  if (!dependents_.empty()) dependents_.add_diagonal(nodes, inverse_.data());
  Space::for_each(nodes.count, kernels::InvertBlocks{data_.view(), inverse_.data(), kind == Preconditioner::jacobi,
                                                     kind == Preconditioner::none});
}

/// v.Ap = K v.p in constraint axes, with the next direction in v.p.
template <class Space>
void System<Space>::apply_tangent(const CgView& v) {
  const kernels::ProductView w = product_view();
  Space::for_each(w.m.nodes.count, kernels::NextDirection{w, v});
  multiply(w);
  if (dependents_.empty()) {
    const kernels::GatherProduct gather{w, blocks_.view()};
    Space::template sum<1>(w.m.nodes.count, kernels::GatherAndFinish{gather, {w, v}}, kernels::TakeCurvature{v});
    return;
  }
  gather_product(w);
  Space::template sum<1>(w.m.nodes.count, kernels::FinishProduct{w, v}, kernels::TakeCurvature{v});
}

/// What blocks make of the direction in world axes, with what depends on it.
template <class Space>
void System<Space>::multiply(const kernels::ProductView& w) {
  if (!dependents_.empty()) dependents_.expand(w.m.nodes, w.d, w.dx, w.dA, w.Q);
  blocks_.product({w.d, w.dx, w.dA});
}

template <class Space>
void System<Space>::gather_product(const kernels::ProductView& w) {
  Space::for_each(w.m.nodes.count, kernels::GatherProduct{w, blocks_.view()});
  if (!dependents_.empty()) dependents_.transfer(w.m.nodes, w.y, nullptr);
}

/// Of what the loops of a product have been recorded with.
template <class Space>
std::uint64_t System<Space>::operator_key() const {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &inverse_step_, sizeof bits);
  return bits * 2 + (tangent_ == Tangent::full ? 1 : 0);
}

template <class Space>
CgReport System<Space>::solve(const CgOptions& options) {
  return cg_.solve(data_.view().nodes, inverse_.data(), options, operator_key(),
                   [&](const CgView& v) { apply_tangent(v); });
}

template <class Space>
DirectionReport System<Space>::direction() {
  linearize(settings_.tangent, true);
  const int n = model_.node_count();
  const double* moved = nullptr;
  if (prescribed_left_) {
    still_.resize(prescribed_.size());
    still_Ap_.resize(prescribed_.size());
    still_.set_zero();
    idle_.set_zero();
    apply_tangent({nullptr, nullptr, prescribed_.data(), still_.data(), still_Ap_.data(), idle_.data()});
    moved = still_Ap_.data();
  }
  const auto right_hand_side = [&] {
    Space::for_each(n, kernels::RightHandSide{data_.view(), gradient_.data(), moved, cg_.rhs()});
  };
  right_hand_side();
  CgOptions options = settings_.cg;
  CgReport cg = solve(options);
  if (cg.status == CgStatus::negative_curvature && !model_.tethers.empty()) {
    linearize(settings_.tangent, false);
    right_hand_side();
    cg = solve(options);
  }
  DirectionReport report;
  report.linear_iterations = cg.iterations;
  if (cg.status == CgStatus::negative_curvature) report.trouble = "CG met negative curvature";
  if (cg.status == CgStatus::not_finite) {
    report.usable = false;
    report.trouble = "CG met a number that is not finite";
    return report;
  }
  Space::template sum<1, 2>(
      n,
      kernels::TakeDirection{data_.view(), cg_.solution(), prescribed_left_ ? prescribed_.data() : nullptr,
                             gradient_.data(), direction_.data()},
      kernels::StoreSums<1, 2>{slope_.data()});
  if (!dependents_.empty()) dependents_.expand(data_.view().nodes, direction_.data(), nullptr, nullptr, Q_.data());
  double values[3];
  slope_.download(values);
  report.slope = values[0];
  report.largest_rotation = values[1];
  report.usable = std::isfinite(values[2]);
  if (!report.usable) report.trouble = "the linear solver returned a number that is not finite";
  return report;
}

template <class Space>
std::vector<double> System<Space>::product(std::span<const double> d) {
  linearize(settings_.tangent, true);
  const NodesView& nodes = data_.view().nodes;
  world_d_.upload(d);
  const kernels::ProductView w = product_view();
  Space::for_each(nodes.count, kernels::SplitDirection{w});
  multiply(w);
  gather_product(w);
  return world_y_.downloaded();
}

}  // namespace fascia::gpu
