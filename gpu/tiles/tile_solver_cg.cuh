#pragma once

#include "gpu/tiles/tile_solver_methods.cuh"

/// Products and CG of a tile solver.
namespace fascia::tile {

/// Places in Solver::cg_.
inline constexpr int kForProduct = 2, kAtEnd = 3;

template <class Constant>
CgState Solver<Constant>::options_state(const CgOptions& options) const {
  CgState state;
  state.tolerance = options.tolerance;
  state.max_iterations = options.max_iterations;
  state.tangent = tangent_;
  state.inverse_step = inverse_step_;
  return state;
}

template <class Constant>
void Solver<Constant>::multiply(const double* x, double* y) {
  VectorArgs vectors = vector_args();
  order_kernel<<<frame_blocks(), kUpdateThreads, 0, stream_>>>(vectors, x, z_.get());
  const CgState state = options_state({});
  check(cudaMemcpyAsync(cg_.get() + kForProduct, &state, sizeof(CgState), cudaMemcpyHostToDevice, stream_),
        "copying settings");
  ProductArgs<Constant> args = product_args();
  args.z = args.p_old = z_.get();
  args.p_new = p_.get();
  args.partials = partials_.get();
  args.curvature_parts = curvature_parts_.get();
  args.in = cg_.get() + kForProduct;
  args.out = cg_.get() + kAtEnd;
  launch_product(args, stream_);
  meet(partial_rows(), {}, stream_);
  gather_kernel<<<frame_blocks(), kUpdateThreads, 0, stream_>>>(vectors, y);
  check(cudaGetLastError(), "summing a product");
}

/// A few iterations, then a look whether the loop goes on.
template <class Constant>
void Solver<Constant>::launch_iterations(cudaStream_t stream, cudaGraphConditionalHandle loop) {
  for (int i = 0; i < kLoopIterations; ++i) {
    ProductArgs<Constant> product = product_args();
    product.z = z_.get();
    product.p_old = i % 2 == 0 ? p_.get() : q_.get();
    product.p_new = i % 2 == 0 ? q_.get() : p_.get();
    product.partials = partials_.get();
    product.rz_parts = residual_sums();
    product.rz_count = residual_count();
    product.curvature_parts = curvature_parts_.get();
    product.in = cg_.get();
    product.out = cg_.get() + 1;
    launch_product(product, stream);
    meet(partial_rows(), {curvature_parts_.get(), product_blocks_, sums_.get()}, stream);
    VectorArgs update = vector_args();
    update.x = x_.get();
    update.r = r_.get();
    update.z = z_.get();
    update.p = product.p_new;
    update.rz_parts = rz_parts_.get();
    update.curvature_parts = curvature_sums();
    update.curvature_count = curvature_count();
    update.in = cg_.get() + 1;
    update.out = cg_.get();
    update_kernel<<<update_blocks_, kUpdateThreads, 0, stream>>>(update);
    meet({}, {rz_parts_.get(), update_blocks_, sums_.get() + 1}, stream);
  }
  decide_kernel<<<1, kUpdateThreads, 0, stream>>>(residual_sums(), residual_count(), cg_.get(), loop);
  check(cudaGetLastError(), "recording iterations");
}

/// A loop on the device: the host neither waits nor launches.
template <class Constant>
void Solver<Constant>::build_graph() {
  if (graph_ != nullptr) return;
  cudaGraph_t graph = nullptr;
  check(cudaGraphCreate(&graph, 0), "making a graph");
  cudaGraphConditionalHandle loop{};
  check(cudaGraphConditionalHandleCreate(&loop, graph, 1, cudaGraphCondAssignDefault), "making a loop");
  cudaGraphNodeParams params{};
  params.type = cudaGraphNodeTypeConditional;
  params.conditional.handle = loop;
  params.conditional.type = cudaGraphCondTypeWhile;
  params.conditional.size = 1;
  cudaGraphNode_t node{};
  check(cudaGraphAddNode(&node, graph, nullptr, nullptr, 0, &params), "adding a loop");
  cudaStream_t stream = nullptr;
  check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "making a stream");
  cudaGraph_t body = params.conditional.phGraph_out[0];
  check(cudaStreamBeginCaptureToGraph(stream, body, nullptr, nullptr, 0, cudaStreamCaptureModeThreadLocal),
        "recording iterations");
  launch_iterations(stream, loop);
  check(cudaStreamEndCapture(stream, &body), "recording iterations");
  check(cudaStreamDestroy(stream), "closing a stream");
  check(cudaGraphInstantiate(&graph_, graph, 0), "preparing a graph");
  check(cudaGraphUpload(graph_, stream_), "preparing a graph");
  check(cudaGraphDestroy(graph), "closing a graph");
}

template <class Constant>
void Solver<Constant>::drop_graph() {
  if (graph_ != nullptr) check(cudaGraphExecDestroy(graph_), "closing a graph");
  graph_ = nullptr;
}

template <class Constant>
void Solver<Constant>::start_solve(const double* b, double* x, const CgOptions& options) {
  const CgState state = options_state(options);
  if (resident_) {
    check(cudaMemsetAsync(partials_.get(), 0xff, partials_.size() * sizeof(double), stream_), "clearing sums");
    check(cudaMemsetAsync(dots_.get(), 0xff, dots_.size() * sizeof(double), stream_), "clearing sums");
    ResidentArgs<Constant> args{tiles_,
                                *resident_,
                                pose_.get(),
                                points_.get(),
                                has_node_blocks_ ? node_blocks_.get() : nullptr,
                                has_held_ ? held_.get() : nullptr,
                                inverse_.get(),
                                b,
                                x,
                                partials_.get(),
                                dots_.get(),
                                layout_.slot_count(),
                                state,
                                cg_.get() + kAtEnd};
    void* parameters[] = {&args};
    check(cudaLaunchCooperativeKernel(reinterpret_cast<const void*>(resident_kernel_), dim3(at(layout_.tile_count)),
                                      dim3(at(resident_threads_)), parameters, at(resident_->bytes), stream_),
          "solving on chip");
    return;
  }
  build_graph();
  VectorArgs vectors = vector_args();
  vectors.x = x_.get();
  vectors.r = r_.get();
  vectors.z = z_.get();
  vectors.rz_parts = rz_parts_.get();
  vectors.out = cg_.get();
  start_kernel<<<update_blocks_, kUpdateThreads, 0, stream_>>>(vectors, b, p_.get(), state);
  check(cudaGetLastError(), "starting CG");
  meet({}, {rz_parts_.get(), update_blocks_, sums_.get() + 1}, stream_);
  check(cudaGraphLaunch(graph_, stream_), "running CG");
  vectors.in = cg_.get();
  vectors.out = cg_.get() + kAtEnd;
  finish_kernel<<<update_blocks_, kUpdateThreads, 0, stream_>>>(vectors, residual_sums(), residual_count(), x);
  check(cudaGetLastError(), "ending CG");
}

template <class Constant>
CgReport Solver<Constant>::finish_solve() {
  CgState state;
  check(cudaMemcpyAsync(&state, cg_.get() + kAtEnd, sizeof(CgState), cudaMemcpyDeviceToHost, stream_), "solving");
  check(cudaStreamSynchronize(stream_), "solving");
  CgReport report;
  report.status = static_cast<CgStatus>(state.status);
  report.iterations = state.iterations;
  if (state.rz_start > 0) report.relative_residual = std::sqrt(std::max(state.rz, 0.0) / state.rz_start);
  return report;
}

template <class Constant>
CgReport Solver<Constant>::solve(const double* b, double* x, const CgOptions& options) {
  start_solve(b, x, options);
  return finish_solve();
}

}  // namespace fascia::tile
