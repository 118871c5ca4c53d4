#pragma once

#include "core/linear/cg.hpp"
#include "gpu/tiles/tile_device.cuh"

/// Kernels over tiles: energies and forces at a state, products, and two-kernel CG.
namespace fascia::tile {

/// Where the parts of a tile stand in shared memory [bytes].
struct SharedPlan {
  int weights = 0, places = 0, point = 0, records = 0, directions = 0, list = 0, list_begin = 0, local = 0, scratch = 0;
  int bytes = 0;
};

/// State of CG between kernels. Each kernel reads one copy and writes the other, so that all blocks of a launch see the
/// same.
struct CgState {
  double rz = 0, rz_start = 0;
  double tolerance = 0;
  int max_iterations = 0;
  int iterations = 0;
  int status = 0;  ///< CgStatus
  int done = 0;
  Tangent tangent = Tangent::full;
  double inverse_step = 0;
};

/// The state of CG that follows from r·z after an update.
__device__ inline CgState judged(CgState s, double rz) {
  if (s.done != 0) return s;
  const auto stop = [&](CgStatus status) {
    s.done = 1;
    s.status = static_cast<int>(status);
  };
  s.rz = rz;
  if (s.iterations == 0) s.rz_start = rz;
  if (s.iterations == 0 && !isfinite(rz))
    stop(CgStatus::not_finite);
  else if (s.iterations == 0 ? rz <= 0 : rz <= s.tolerance * s.tolerance * s.rz_start)
    stop(CgStatus::converged);
  else if (s.iterations >= s.max_iterations)
    stop(CgStatus::limit);
  return s;
}

template <class Constant>
struct ProductArgs {
  DeviceTiles<Constant> tiles;
  SharedPlan plan;
  const double* pose;         ///< (frames × 12) Q, rest position
  const double* points;       ///< (tiles × words × lanes)
  const double* node_blocks;  ///< (21 × frames) or null
  const double* z;            ///< (frames × 6)
  const double* p_old;
  double* p_new;
  double* partials;  ///< (slots × 6)
  const double* rz_parts;
  int rz_count;
  double* curvature_parts;  ///< (blocks)
  const CgState* in;
  CgState* out;
};

/// Lets the block copy a tile's constants; wait_copies() and a barrier complete it.
template <class Constant>
__device__ inline void copy_constants(const DeviceTiles<Constant>& t, const SharedPlan& plan, char* shared, int tile) {
  const int P = t.tile_size, K = t.influences;
  const auto first = static_cast<std::size_t>(tile) * static_cast<std::size_t>(P);
  copy_block(shared + plan.weights, t.weights + first * 4 * K, 4 * K * P * static_cast<int>(sizeof(Constant)));
  copy_block(shared + plan.places, t.places + first * 4, 4 * P * static_cast<int>(sizeof(Constant)));
  copy_block(shared + plan.local, t.local + first * K, K * P);
}
template <class Constant>
__device__ inline void copy_lists(const DeviceTiles<Constant>& t, const SharedPlan& plan, char* shared, int tile) {
  const int P = t.tile_size, K = t.influences;
  const auto n = static_cast<std::size_t>(tile);
  copy_block(shared + plan.list, t.list + n * P * K, 2 * K * P);
  copy_block(shared + plan.list_begin, t.list_begin + n * t.list_stride, 2 * t.list_stride);
}

/// Blocks of kernels that take tiles of any size have a thread for each lane, in whole warps.
inline constexpr int kMostTileThreads = 320;

__device__ inline int numbered(const TileFrame& f) { return 2 * f.frame + f.writer; }

/// Threads and residency that kernels are compiled for: 128 registers a thread where the tile size is known, 168 with
/// drilling.
constexpr int block_threads(int lanes) { return lanes > 0 ? lanes : kMostTileThreads; }
constexpr int resident_blocks(int lanes, bool drilling) { return lanes > 0 ? (drilling ? 384 : 512) / lanes : 1; }

/// p = z + β p_old of all touched frames, then one partial of K p for each frame of each tile, and parts of p · K p.
/// @param Threads  lanes of a tile; 0: any number
template <int K, int Threads, bool Drilling, class Constant>
__global__ __launch_bounds__(block_threads(Threads),
                             resident_blocks(Threads, Drilling)) void product_kernel(ProductArgs<Constant> a) {
  extern __shared__ __align__(16) char shared[];
  constexpr int kWords = kPointWords<Drilling>;
  const int P = Threads > 0 ? Threads : a.tiles.tile_size;
  const int threads = Threads > 0 ? Threads : static_cast<int>(blockDim.x);
  auto* const scratch = reinterpret_cast<double*>(shared + a.plan.scratch);
  const auto* const weights = reinterpret_cast<const Constant*>(shared + a.plan.weights);
  const auto* const places = reinterpret_cast<const Constant*>(shared + a.plan.places);
  auto* const point = reinterpret_cast<double*>(shared + a.plan.point);
  auto* const records = reinterpret_cast<double*>(shared + a.plan.records);
  auto* const directions = reinterpret_cast<double*>(shared + a.plan.directions);
  const auto* const list = reinterpret_cast<const std::uint16_t*>(shared + a.plan.list);
  const auto* const list_begin = reinterpret_cast<const std::uint16_t*>(shared + a.plan.list_begin);
  const auto* const local = reinterpret_cast<const std::uint8_t*>(shared + a.plan.local);
  const int tid = static_cast<int>(threadIdx.x);

  CgState state = *a.in;
  double beta = 0;
  if (state.done == 0 && a.rz_parts != nullptr) {
    const double old = state.rz;
    state = judged(state, sum_of_blocks(a.rz_parts, a.rz_count, scratch));
    beta = state.iterations > 0 ? state.rz / old : 0.0;
  }
  if (blockIdx.x == 0 && tid == 0) *a.out = state;
  if (state.done != 0) return;

  // Numbers of the frames of the next tile are on their way while this one is computed.
  double curvature = 0;
  int ahead = 0;  // 2 × frame + whether this tile writes it
  int first_ahead = 0, frames_ahead = 0;
  const auto look_ahead = [&](int tile) {
    if (tile >= a.tiles.tile_count) return;
    first_ahead = a.tiles.tile_frame_begin[tile];
    frames_ahead = a.tiles.tile_frame_begin[tile + 1] - first_ahead;
    if (tid < frames_ahead) ahead = numbered(a.tiles.tile_frames[first_ahead + tid]);
  };
  look_ahead(static_cast<int>(blockIdx.x));
  for (int tile = static_cast<int>(blockIdx.x); tile < a.tiles.tile_count; tile += static_cast<int>(gridDim.x)) {
    const int first = first_ahead, frames = frames_ahead;
    copy_constants(a.tiles, a.plan, shared, tile);
    copy_block(point, a.points + static_cast<std::size_t>(tile) * kWords * P, kWords * P * 8);
    copy_lists(a.tiles, a.plan, shared, tile);
    const TileHead head = a.tiles.head[tile];
    const bool has_point = Threads > 0 || tid < P;
    const int material_number = has_point ? a.tiles.material[static_cast<std::size_t>(tile) * P + tid] : 0;
    for (int f = tid; f < frames; f += threads) {
      const int number = f < threads ? ahead : numbered(a.tiles.tile_frames[first + f]);
      const auto n = static_cast<std::size_t>(number / 2);
      double p[kDofs], old[kDofs], pose[kPose];
      load_words<kDofs>(a.z + kDofs * n, p);
      load_words<kDofs>(a.p_old + kDofs * n, old);
      load_words<kPose>(a.pose + kPose * n, pose);
#pragma unroll
      for (int i = 0; i < kDofs; ++i) p[i] += beta * old[i];
      if (number % 2 != 0) store_words<kDofs>(a.p_new + kDofs * n, p);
      store_words<kDofs>(directions + kDofs * f, p);
      write_direction(p, pose, head, records + kRecordStride * f);
    }
    const TileMaterial constants = a.tiles.materials[material_number];
    look_ahead(tile + static_cast<int>(gridDim.x));
    wait_copies();
    __syncthreads();

    if (has_point) {
      const Vec3d X{{places[tid], places[P + tid], places[2 * P + tid]}};
      Mat3d tg, wA, dP, dW;
      blend_frames<K>(records, weights, local, P, a.tiles.influences, tid, X, tg, wA);
      const auto material = solid_material(constants, places[3 * P + tid], state.inverse_step);
      stress_of_direction<Drilling>(point + tid, P, material, state.tangent, tg, wA, head.blend, dP, dW);
      store_matrix(point + tid, P, dP);
      if constexpr (Drilling) store_matrix(point + 9 * P + tid, P, dW);
    }
    __syncthreads();

    for (int base = 0; base < frames; base += threads / 2) {
      const int f = base + tid / 2;
      TileFrame frame;
      double pose[kPose];
      FrameSum sum;
      if (f < frames) {
        frame = a.tiles.tile_frames[first + f];
        load_words<kPose>(a.pose + kPose * static_cast<std::size_t>(frame.frame), pose);
        gather_list<Drilling>(point, weights, places, list, list_begin[f], list_begin[f + 1], P, tid % 2, 2, sum);
      }
      add_neighbours<2>(sum);
      if (f < frames && tid % 2 == 0) {
        double y[kDofs];
        finish_frame(sum, pose, head, y);
        if (frame.owner != 0 && a.node_blocks != nullptr)
          add_packed(a.node_blocks + frame.frame, static_cast<std::size_t>(a.tiles.frame_count), directions + kDofs * f,
                     y);
        store_words<kDofs>(a.partials + kDofs * static_cast<std::size_t>(frame.slot), y);
        curvature += dot6(directions + kDofs * f, y);
      }
    }
    __syncthreads();
  }
  const double part = block_sum(curvature, scratch);
  if (tid == 0) a.curvature_parts[blockIdx.x] = part;
}

/// z = M⁻¹ r with a packed inverse, or r where there is none.
__device__ inline void precondition(const float* inverse, std::size_t frame, std::size_t frames, const double* r,
                                    double* z) {
#pragma unroll
  for (int i = 0; i < kDofs; ++i) z[i] = inverse == nullptr ? r[i] : 0.0;
  if (inverse != nullptr) add_packed(inverse + frame, frames, r, z);
}

/// Clears the degrees of freedom that a bit mask holds.
__device__ inline void clear_held(unsigned mask, double* v) {
#pragma unroll
  for (int i = 0; i < kDofs; ++i)
    if ((mask >> i & 1U) != 0) v[i] = 0;
}
__device__ inline void clear_held(const std::uint8_t* held, std::size_t frame, double* v) {
  if (held != nullptr) clear_held(held[frame], v);
}

/// Σ of a frame's partials, in the order of its tiles.
__device__ inline void sum_partials(const double* partials, int begin, int end, double* y) {
#pragma unroll
  for (int i = 0; i < kDofs; ++i) y[i] = 0;
  constexpr int kAhead = 2;  // on their way at a time
  for (int first = begin; first < end; first += kAhead) {
    double part[kAhead][kDofs];
#pragma unroll
    for (int s = 0; s < kAhead; ++s)
      if (first + s < end) load_words<kDofs>(partials + kDofs * static_cast<std::size_t>(first + s), part[s]);
#pragma unroll
    for (int s = 0; s < kAhead; ++s) {
#pragma unroll
      for (int i = 0; i < kDofs; ++i)
        if (first + s < end) y[i] += part[s][i];
    }
  }
}

struct VectorArgs {
  int frame_count;
  int owned;  ///< the first frames; the others belong to other devices
  const int* frame_slot_begin;
  const int* frame_node;
  const std::uint8_t* held;  ///< (frames) bits of held degrees of freedom, or null
  const float* inverse;      ///< (21 × frames) or null
  const double* partials;
  double *x, *r, *z;
  const double* p;  ///< of the product before
  double* rz_parts;
  const double* curvature_parts;
  int curvature_count;
  const CgState* in;
  CgState* out;
};

inline constexpr int kUpdateThreads = 128;

/// α, x, r, z and parts of r · z. Five blocks on each multiprocessor: the registers hold what is on its way.
static __global__ __launch_bounds__(kUpdateThreads, 5) void update_kernel(VectorArgs a) {
  __shared__ double scratch[33];
  CgState state = *a.in;
  double alpha = 0;
  if (state.done == 0) {
    const double curvature = sum_of_blocks(a.curvature_parts, a.curvature_count, scratch);
    const bool finite = isfinite(curvature), first = state.iterations == 0;
    alpha = first && finite ? 1.0 : 0.0;
    if (finite && curvature > 0) {
      alpha = state.rz / curvature;
      ++state.iterations;
    } else {
      state.done = 1;
      state.status = static_cast<int>(finite ? CgStatus::negative_curvature : CgStatus::not_finite);
    }
  }
  if (blockIdx.x == 0 && threadIdx.x == 0) *a.out = state;
  if (alpha == 0) return;
  double rz = 0;
  const int step = static_cast<int>(gridDim.x * blockDim.x);
  for (int f = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x); f < a.frame_count; f += step) {
    const auto n = static_cast<std::size_t>(f);
    double p[kDofs], x[kDofs], r[kDofs], z[kDofs], Ap[kDofs];
    load_words<kDofs>(a.p + kDofs * n, p);
    load_words<kDofs>(a.x + kDofs * n, x);
    load_words<kDofs>(a.r + kDofs * n, r);
    sum_partials(a.partials, a.frame_slot_begin[f], a.frame_slot_begin[f + 1], Ap);
    clear_held(a.held, n, Ap);
#pragma unroll
    for (int i = 0; i < kDofs; ++i) {
      x[i] += alpha * p[i];
      r[i] -= alpha * Ap[i];
    }
    store_words<kDofs>(a.x + kDofs * n, x);
    if (state.done != 0) continue;
    precondition(a.inverse, n, static_cast<std::size_t>(a.frame_count), r, z);
    store_words<kDofs>(a.r + kDofs * n, r);
    store_words<kDofs>(a.z + kDofs * n, z);
    if (f < a.owned) rz += dot6(r, z);
  }
  const double part = block_sum(rz, scratch);
  if (threadIdx.x == 0) a.rz_parts[blockIdx.x] = part;
}

/// x = 0, r = b without what is held, z = M⁻¹ r, p = 0.
/// @param b  by node
static __global__ __launch_bounds__(kUpdateThreads) void start_kernel(VectorArgs a, const double* b, double* p,
                                                                      CgState state) {
  __shared__ double scratch[33];
  if (blockIdx.x == 0 && threadIdx.x == 0) *a.out = state;
  double rz = 0;
  const int step = static_cast<int>(gridDim.x * blockDim.x);
  for (int f = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x); f < a.frame_count; f += step) {
    const auto n = static_cast<std::size_t>(f);
    double r[kDofs], z[kDofs];
    const double zero[kDofs]{};
    load_words<kDofs>(b + kDofs * static_cast<std::size_t>(a.frame_node[f]), r);
    clear_held(a.held, n, r);
    precondition(a.inverse, n, static_cast<std::size_t>(a.frame_count), r, z);
    store_words<kDofs>(a.x + kDofs * n, zero);
    store_words<kDofs>(p + kDofs * n, zero);
    store_words<kDofs>(a.r + kDofs * n, r);
    store_words<kDofs>(a.z + kDofs * n, z);
    if (f < a.owned) rz += dot6(r, z);
  }
  const double part = block_sum(rz, scratch);
  if (threadIdx.x == 0) a.rz_parts[blockIdx.x] = part;
}

/// Decides whether CG goes on: sets the condition of a graph's loop. One block.
static __global__ void decide_kernel(const double* rz_parts, int count, const CgState* in,
                                     cudaGraphConditionalHandle loop) {
  __shared__ double scratch[33];
  const CgState s = judged(*in, sum_of_blocks(rz_parts, count, scratch));
  if (threadIdx.x == 0) cudaGraphSetConditional(loop, s.done != 0 ? 0 : 1);
}

/// The solution by node, and the state at the end.
static __global__ __launch_bounds__(kUpdateThreads) void finish_kernel(VectorArgs a, const double* rz_parts,
                                                                       int rz_count, double* solution) {
  __shared__ double scratch[33];
  const CgState s = judged(*a.in, sum_of_blocks(rz_parts, rz_count, scratch));
  if (blockIdx.x == 0 && threadIdx.x == 0) *a.out = s;
  const int step = static_cast<int>(gridDim.x * blockDim.x);
  for (int f = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x); f < a.owned; f += step) {
    double x[kDofs];
    load_words<kDofs>(a.x + kDofs * static_cast<std::size_t>(f), x);
    store_words<kDofs>(solution + kDofs * static_cast<std::size_t>(a.frame_node[f]), x);
  }
}

/// y = Σ partials without what is held, by node.
static __global__ __launch_bounds__(kUpdateThreads) void gather_kernel(VectorArgs a, double* y) {
  const int f = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (f >= a.owned) return;
  double sum[kDofs];
  sum_partials(a.partials, a.frame_slot_begin[f], a.frame_slot_begin[f + 1], sum);
  clear_held(a.held, static_cast<std::size_t>(f), sum);
  store_words<kDofs>(y + kDofs * static_cast<std::size_t>(a.frame_node[f]), sum);
}

/// A vector by node in the order of frames.
static __global__ __launch_bounds__(kUpdateThreads) void order_kernel(VectorArgs a, const double* v, double* out) {
  const int f = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (f >= a.frame_count) return;
  double x[kDofs];
  load_words<kDofs>(v + kDofs * static_cast<std::size_t>(a.frame_node[f]), x);
  store_words<kDofs>(out + kDofs * static_cast<std::size_t>(f), x);
}

}  // namespace fascia::tile
