#pragma once

#include "gpu/tiles/tile_kernel_choice.cuh"
#include "gpu/tiles/tile_solver_impl.cuh"

#include <algorithm>
#include <cmath>

namespace fascia::tile {

template <class Constant>
SharedPlan shared_plan(const TileLayout& layout) {
  const std::size_t P = at(layout.tile_size), K = at(layout.influences), F = at(layout.most_frames);
  Carver carver;
  SharedPlan plan;
  plan.weights = carver.take(4 * K * P * sizeof(Constant));
  plan.places = carver.take(4 * P * sizeof(Constant));
  plan.point = carver.take(at(layout.drilling ? kPointWords<true> : kPointWords<false>) * P * sizeof(double));
  plan.records = carver.take(F * kRecordStride * sizeof(double));
  plan.directions = carver.take(F * kDofs * sizeof(double));
  plan.list = carver.take(K * P * sizeof(std::uint16_t));
  plan.list_begin = carver.take(at(layout.list_stride()) * sizeof(std::uint16_t));
  plan.local = carver.take(K * P);
  plan.scratch = carver.take(33 * sizeof(double));
  plan.bytes = carver.bytes();
  return plan;
}

template <class Constant>
ResidentPlan resident_plan(const TileLayout& layout) {
  const std::size_t P = at(layout.tile_size), K = at(layout.influences);
  Carver carver;
  ResidentPlan plan;
  plan.frame_stride = layout.most_frames + layout.most_frames % 2;
  const std::size_t F = at(plan.frame_stride);
  plan.weights = carver.take(4 * K * P * sizeof(Constant));
  plan.places = carver.take(4 * P * sizeof(Constant));
  plan.stress = carver.take(at(layout.drilling ? kStressWords<true> : kStressWords<false>) * P * sizeof(double));
  plan.point = carver.take(at(layout.drilling ? kPointWords<true> : kPointWords<false>) * P * sizeof(double));
  plan.records = carver.take(F * kRecordStride * sizeof(double));
  plan.frames = carver.take(F * kFrameRows * sizeof(double));
  plan.inverse = carver.take(F * kPacked * sizeof(float));
  plan.list = carver.take(K * P * sizeof(std::uint16_t));
  plan.list_begin = carver.take(at(layout.list_stride()) * sizeof(std::uint16_t));
  plan.local = carver.take(K * P);
  plan.slots = carver.take(2 * F * sizeof(int));
  plan.scratch = carver.take(33 * sizeof(double));
  plan.bytes = carver.bytes();
  return plan;
}

template <class Constant>
Solver<Constant>::Solver(TileShare share, std::optional<ResidentPlan> resident, const DeviceLimits& limits,
                         cudaStream_t stream)
    : share_(std::move(share)), stream_(stream), resident_(resident) {
  if (layout_.materials.empty()) layout_.materials.emplace_back();
  plan_ = shared_plan<Constant>(layout_);
  upload();
  choose_kernels(limits);
  const std::size_t n = at(layout_.frame_count) * kDofs, slots = at(layout_.slot_count());
  pose_.resize(at(layout_.frame_count) * kPose);
  motion_.resize(at(layout_.frame_count) * kMotion);
  points_.resize(layout_.lanes() * at(words()));
  inverse_.resize(at(layout_.frame_count) * kPacked);
  for (Buffer<double>* v : {&x_, &r_, &z_, &p_, &q_}) v->resize(n);
  partials_.resize((resident_ ? 2 : 1) * slots * kDofs);
  if (resident_) dots_.resize(4 * kReplicas * at(layout_.tile_count));
  rz_parts_.resize(at(update_blocks_));
  curvature_parts_.resize(at(product_blocks_));
  energy_parts_.resize(3 * at(state_blocks_));
  cg_.upload(std::vector<CgState>(4));
  clear_preconditioner();  // waits for all copies
}

template <class Constant>
Solver<Constant>::~Solver() {
  if (graph_ != nullptr) cudaGraphExecDestroy(graph_);
}

/// Uploads the layout and drops the arrays of constants on the host.
template <class Constant>
void Solver<Constant>::upload() {
  const auto move_constants = [](std::vector<double>& from, Buffer<Constant>& to) {
    if constexpr (std::is_same_v<Constant, double>)
      to.upload(from);
    else
      to.upload(std::vector<Constant>(from.begin(), from.end()));
    from = {};
  };
  const auto move_array = [](auto& from, auto& to) {
    to.upload(from);
    from = {};
  };
  move_constants(layout_.weights, weights_);
  move_constants(layout_.places, places_);
  move_array(layout_.material, material_);
  move_array(layout_.local, local_);
  move_array(layout_.list, list_);
  move_array(layout_.list_begin, list_begin_);
  move_array(layout_.tile_frames, tile_frames_);
  head_.upload(layout_.head);
  materials_.upload(layout_.materials);
  tile_frame_begin_.upload(layout_.tile_frame_begin);
  frame_node_.upload(layout_.frame_node);
  frame_slot_begin_.upload(layout_.frame_slot_begin);
  slot_tile_.upload(layout_.slot_tile);
  slot_tile_frame_.upload(layout_.slot_tile_frame);
  std::vector<double> rest;
  for (const Vec3d& x : layout_.rest_position) rest.insert(rest.end(), x.v, x.v + 3);
  rest_.upload(rest);
  tiles_ = {
      layout_.tile_size, layout_.influences,      layout_.tile_count, layout_.frame_count,   layout_.list_stride(),
      weights_.get(),    places_.get(),           material_.get(),    local_.get(),          list_.get(),
      list_begin_.get(), tile_frame_begin_.get(), tile_frames_.get(), head_.get(),           materials_.get(),
      frame_node_.get(), frame_slot_begin_.get(), slot_tile_.get(),   slot_tile_frame_.get()};
}

template <class Constant>
void Solver<Constant>::wait_for_copies() const {
  if (stream_ != nullptr) check(cudaStreamSynchronize(cudaStreamLegacy), "copying to the device");
}

template <class Constant>
void Solver<Constant>::choose_kernels(const DeviceLimits& limits) {
  const bool drilling = layout_.drilling;
  const int P = layout_.tile_size, K = layout_.influences;
  threads_ = (P + 31) / 32 * 32;
  const auto blocks_of = [&](auto kernel) {
    check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, plan_.bytes),
          "asking for shared memory");
    int of_each = 0;
    check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&of_each, kernel, threads_, at(plan_.bytes)),
          "asking for residency");
    return std::min(layout_.tile_count, std::max(1, of_each) * limits.multiprocessors);
  };
  product_ = drilling ? choose_product<true, Constant>(K, P) : choose_product<false, Constant>(K, P);
  product_blocks_ = blocks_of(product_);
  state_ = drilling ? state_kernel<true, Constant> : state_kernel<false, Constant>;
  state_blocks_ = blocks_of(state_);
  jacobi_ = drilling ? jacobi_kernel<true, Constant> : jacobi_kernel<false, Constant>;
  int updates = 0;
  check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&updates, update_kernel, kUpdateThreads, 0),
        "asking for residency");
  update_blocks_ = std::min(frame_blocks(), std::max(1, updates) * limits.multiprocessors);
  if (!resident_) return;
  const ResidentChoice<Constant> chosen = drilling ? choose_resident<true, Constant>(K, P, layout_.most_frames)
                                                   : choose_resident<false, Constant>(K, P, layout_.most_frames);
  resident_kernel_ = chosen.kernel;
  resident_threads_ = chosen.threads;
  check(cudaFuncSetAttribute(resident_kernel_, cudaFuncAttributeMaxDynamicSharedMemorySize, resident_->bytes),
        "asking for shared memory");
}

template <class Constant>
StateArgs<Constant> Solver<Constant>::state_args(double inverse_step) const {
  StateArgs<Constant> args{};
  args.tiles = tiles_;
  args.plan = plan_;
  args.motion = motion_.get();
  args.inverse_step = strain_.size() > 0 ? inverse_step : 0.0;
  args.E_old = args.inverse_step > 0 ? strain_.get() : nullptr;
  return args;
}

template <class Constant>
void Solver<Constant>::run_state(const double* u, const double* D, StateArgs<Constant> args) {
  pose_kernel<<<frame_blocks(), kUpdateThreads, 0, stream_>>>(layout_.frame_count, frame_node_.get(), rest_.get(), u, D,
                                                              motion_.get(), pose_.get());
  check(cudaGetLastError(), "ordering poses");
  state_<<<state_blocks_, threads_, at(plan_.bytes), stream_>>>(args);
  check(cudaGetLastError(), "computing points");
}

template <class Constant>
void Solver<Constant>::store_strain(const double* u, const double* D) {
  strain_.resize(layout_.lanes() * 6);
  StateArgs<Constant> args = state_args(0);
  args.strain = strain_.get();
  run_state(u, D, args);
}

template <class Constant>
void Solver<Constant>::forces(const double* u, const double* D, double inverse_step, double* gradient,
                              double* moments) {
  prepare_forces();
  StateArgs<Constant> args = state_args(inverse_step);
  args.partials = gradient_partials_.get();
  run_state(u, D, args);
  sum_forces(gradient, moments);
}

template <class Constant>
void Solver<Constant>::sum_forces(double* gradient, double* moments) {
  meet(rows_of(partial_exports_, kGradient, &Solver::gradient_partials_), {}, stream_);
  gradient_kernel<<<frame_blocks(), kUpdateThreads, 0, stream_>>>(share_.owned, frame_node_.get(),
                                                                  frame_slot_begin_.get(), gradient_partials_.get(),
                                                                  pose_.get(), gradient, moments);
  check(cudaGetLastError(), "summing forces");
}

template <class Constant>
void Solver<Constant>::start_gradient(const double* u, const double* D, double inverse_step, double* gradient,
                                      double* moments) {
  prepare_forces();
  StateArgs<Constant> args = state_args(inverse_step);
  args.partials = gradient_partials_.get();
  args.energy_parts = energy_parts_.get();
  run_state(u, D, args);
  sum_forces(gradient, moments);
}

template <class Constant>
TileEnergy Solver<Constant>::finish_gradient() {
  check(cudaStreamSynchronize(stream_), "waiting for forces");
  const std::vector<double> parts = energy_parts_.download();
  const auto sum = [&](int term) {
    double total = 0;
    for (int b = 0; b < state_blocks_; ++b) total += parts[at(term * state_blocks_ + b)];
    return total;
  };
  return {sum(0), sum(1), sum(2)};
}

template <class Constant>
TileEnergy Solver<Constant>::gradient(const double* u, const double* D, double inverse_step, double* gradient,
                                      double* moments) {
  start_gradient(u, D, inverse_step, gradient, moments);
  return finish_gradient();
}

template <class Constant>
void Solver<Constant>::linearize(const double* u, const double* D, Tangent tangent, double inverse_step) {
  StateArgs<Constant> args = state_args(inverse_step);
  args.points = points_.get();
  run_state(u, D, args);
  tangent_ = tangent;
  inverse_step_ = args.inverse_step;
}

template <class Constant>
void Solver<Constant>::set_node_blocks(const double* blocks) {
  const bool before = has_node_blocks_;
  has_node_blocks_ = blocks != nullptr;
  if (before != has_node_blocks_) drop_graph();
  if (!has_node_blocks_) return;
  node_blocks_.resize(at(layout_.frame_count) * kPacked);
  pack_blocks_kernel<<<frame_blocks(), kUpdateThreads, 0, stream_>>>(layout_.frame_count, frame_node_.get(), blocks,
                                                                     node_blocks_.get());
  check(cudaGetLastError(), "packing node blocks");
}

template <class Constant>
void Solver<Constant>::set_held(std::span<const std::uint8_t> held) {
  drop_graph();
  has_held_ = !held.empty();
  std::vector<std::uint8_t> by_frame;
  for (const int node : layout_.frame_node)
    if (has_held_) by_frame.push_back(held[at(node)]);
  check(cudaStreamSynchronize(stream_), "waiting for the last solve");
  held_.upload(by_frame);
  wait_for_copies();
}

template <class Constant>
void Solver<Constant>::build_preconditioner() {
  const int blocks = (layout_.frame_count + kJacobiFrames - 1) / kJacobiFrames;
  const JacobiArgs args{
      has_held_ ? held_.get() : nullptr,       tangent_,     inverse_step_, share_.owned, inverse_.get(),
      alone() ? nullptr : shared_place_.get(), blocks_.get()};
  jacobi_<<<blocks, kJacobiFrames * kJacobiLanes, 0, stream_>>>(product_args(), args);
  check(cudaGetLastError(), "building the preconditioner");
  if (alone()) return;
  meet(rows_of(block_exports_, kBlock, &Solver::blocks_), {}, stream_);
  const int count = static_cast<int>(share_.shared.size());
  if (count == 0) return;
  shared_jacobi_kernel<<<(count + kUpdateThreads - 1) / kUpdateThreads, kUpdateThreads, 0, stream_>>>(
      count, shared_.get(), shared_block_begin_.get(), layout_.frame_count, args);
  check(cudaGetLastError(), "building the preconditioner");
}

template <class Constant>
void Solver<Constant>::clear_preconditioner() {
  const std::size_t frames = at(layout_.frame_count);
  std::vector<float> identity(frames * kPacked, 0.0F);
  for (int i = 0, n = 0; i < kDofs; n += kDofs - i, ++i)
    std::fill_n(identity.begin() + static_cast<std::ptrdiff_t>(at(n) * frames), frames, 1.0F);
  check(cudaStreamSynchronize(stream_), "waiting for the last solve");
  inverse_.upload(identity);
  wait_for_copies();
}

template <class Constant>
ProductArgs<Constant> Solver<Constant>::product_args() const {
  ProductArgs<Constant> args{};
  args.tiles = tiles_;
  args.plan = plan_;
  args.pose = pose_.get();
  args.points = points_.get();
  args.node_blocks = has_node_blocks_ ? node_blocks_.get() : nullptr;
  return args;
}

template <class Constant>
VectorArgs Solver<Constant>::vector_args() const {
  VectorArgs args{};
  args.frame_count = layout_.frame_count;
  args.owned = share_.owned;
  args.frame_slot_begin = frame_slot_begin_.get();
  args.frame_node = frame_node_.get();
  args.held = has_held_ ? held_.get() : nullptr;
  args.inverse = inverse_.get();
  args.partials = partials_.get();
  return args;
}

template <class Constant>
void Solver<Constant>::launch_product(const ProductArgs<Constant>& args, cudaStream_t stream) {
  product_<<<product_blocks_, threads_, at(plan_.bytes), stream>>>(args);
  check(cudaGetLastError(), "computing a product");
}

}  // namespace fascia::tile
