#pragma once

#include "gpu/tiles/tile_kernels.cuh"

/// CG of small problems in one launch: each block keeps a tile and the vectors of all frames that it touches, and only
/// partial sums of products and two numbers a block travel. Chronopoulos and Gear (1989): one synchronisation an
/// iteration,
///   w = A z,  γ = r · z,  δ = z · w,  β = γ / γ_old,  α = γ / (δ − β γ / α_old),
///   p = z + β p,  s = w + β s,  x += α p,  r −= α s,  z = M⁻¹ r.
/// Frames of several tiles are updated in each of them from the same sums in the same order, so all copies agree.
namespace fascia::tile {

/// Where the parts of a resident tile stand in shared memory [bytes]. Vectors of frames are (words × frame_stride).
struct ResidentPlan {
  int frame_stride = 0;
  int weights = 0, places = 0, stress = 0, point = 0, records = 0, frames = 0, inverse = 0, list = 0, list_begin = 0,
      local = 0, slots = 0, scratch = 0;
  int bytes = 0;
};

/// Rows of ResidentPlan::frames.
inline constexpr int kRowR = 0, kRowS = 6, kRowZ = 12, kRowP = 18, kRowX = 24, kRowPose = 30, kFrameRows = 42;

/// Threads of a block at most: one for each point and each frame.
constexpr int resident_threads(int lanes) { return lanes == 1 ? 320 : 256; }

template <class Constant>
struct ResidentArgs {
  DeviceTiles<Constant> tiles;
  ResidentPlan plan;
  const double* pose;
  const double* points;
  const double* node_blocks;
  const std::uint8_t* held;
  const float* inverse;
  const double* b;   ///< by node
  double* solution;  ///< by node
  double* partials;  ///< (2 × slots × 6), lowest bits set
  double* dots;      ///< (2 × kReplicas × blocks × 2), lowest bits set
  int slot_count;
  CgState state;
  CgState* out;
};

/// A word travels with the lowest bit of its mantissa as a flag: it is there when the bit says so, without fences.
__device__ inline double flagged(double value, unsigned flag) {
  const long long bits = __double_as_longlong(value);
  return __longlong_as_double((bits & ~1LL) | static_cast<long long>(flag));
}
__device__ inline void send(double* to, double a, double b, unsigned flag) {
  asm volatile("st.relaxed.gpu.global.v2.f64 [%0], {%1, %2};" ::"l"(to), "d"(flagged(a, flag)), "d"(flagged(b, flag))
               : "memory");
}
__device__ inline double2 look(const double* from) {
  double2 v;
  asm volatile("ld.relaxed.gpu.global.v2.f64 {%0, %1}, [%2];" : "=d"(v.x), "=d"(v.y) : "l"(from) : "memory");
  return v;
}
__device__ inline bool arrived(const double2& v, unsigned flag) {
  const auto bits = static_cast<unsigned>((__double_as_longlong(v.x) & 1LL) + (__double_as_longlong(v.y) & 1LL));
  return bits == 2 * flag;
}
/// Copies of what blocks send to all, so that not all of them ask for the same words.
inline constexpr int kReplicas = 8;

/// γ and δ of all blocks, summed by one warp.
__device__ inline double2 receive_dots(const double* dots, int blocks, unsigned flag) {
  double2 sum = make_double2(0, 0);
  constexpr int kAhead = 5;
  const int lane = static_cast<int>(threadIdx.x) % 32;
  for (int first = lane; first < blocks; first += 32 * kAhead) {
    double2 v[kAhead];
    bool missing = true;
    while (missing) {
      missing = false;
#pragma unroll
      for (int i = 0; i < kAhead; ++i)
        if (first + 32 * i < blocks) v[i] = look(dots + 2 * (first + 32 * i));
#pragma unroll
      for (int i = 0; i < kAhead; ++i)
        if (first + 32 * i < blocks) missing = missing || !arrived(v[i], flag);
    }
#pragma unroll
    for (int i = 0; i < kAhead; ++i) {
      if (first + 32 * i >= blocks) continue;
      sum.x += v[i].x;
      sum.y += v[i].y;
    }
  }
#pragma unroll
  for (int step = 16; step > 0; step /= 2) {
    sum.x += __shfl_xor_sync(0xffffffffU, sum.x, step);
    sum.y += __shfl_xor_sync(0xffffffffU, sum.y, step);
  }
  return sum;
}

/// Σ of a frame's partials in the order of its tiles. All that are missing are asked for at once: one after the other
/// each would cost a way to memory and back.
__device__ inline void receive_partials(const double* partials, int begin, int end, unsigned flag, double* w) {
  constexpr int kAhead = 4;
#pragma unroll
  for (int i = 0; i < kDofs; ++i) w[i] = 0;
  for (int first = begin; first < end; first += kAhead) {
    double2 v[kAhead][kDofs / 2];
    bool missing = true;
    while (missing) {
      missing = false;
#pragma unroll
      for (int s = 0; s < kAhead; ++s)
#pragma unroll
        for (int i = 0; i < kDofs / 2; ++i)
          if (first + s < end) v[s][i] = look(partials + kDofs * (first + s) + 2 * i);
#pragma unroll
      for (int s = 0; s < kAhead; ++s)
#pragma unroll
        for (int i = 0; i < kDofs / 2; ++i)
          if (first + s < end) missing = missing || !arrived(v[s][i], flag);
    }
#pragma unroll
    for (int s = 0; s < kAhead; ++s) {
      if (first + s >= end) continue;
#pragma unroll
      for (int i = 0; i < kDofs / 2; ++i) {
        w[2 * i] += v[s][i].x;
        w[2 * i + 1] += v[s][i].y;
      }
    }
  }
}

template <int N>
__device__ inline void load_rows(const double* rows, int stride, double* to) {
#pragma unroll
  for (int i = 0; i < N; ++i) to[i] = rows[i * stride];
}
template <int N>
__device__ inline void store_rows(double* rows, int stride, const double* from) {
#pragma unroll
  for (int i = 0; i < N; ++i) rows[i * stride] = from[i];
}

/// Where the sums over all blocks stand in the scratch, behind two words of each warp.
inline constexpr int kSums = 20;

/// @param Lanes   threads of a point
/// @param Gather  threads of a frame while its list is summed
template <int K, int Lanes, int Gather, bool Drilling, class Constant>
__global__ __launch_bounds__(resident_threads(Lanes), 1) void resident_kernel(ResidentArgs<Constant> a) {
  extern __shared__ __align__(16) char shared[];
  constexpr int kWords = kPointWords<Drilling>;
  auto* const scratch = reinterpret_cast<double*>(shared + a.plan.scratch);
  auto* const weights = reinterpret_cast<const Constant*>(shared + a.plan.weights);
  auto* const places = reinterpret_cast<const Constant*>(shared + a.plan.places);
  auto* const stress = reinterpret_cast<double*>(shared + a.plan.stress);
  auto* const records = reinterpret_cast<double*>(shared + a.plan.records);
  auto* const rows = reinterpret_cast<double*>(shared + a.plan.frames);
  auto* const inverse = reinterpret_cast<float*>(shared + a.plan.inverse);
  auto* const slots = reinterpret_cast<int*>(shared + a.plan.slots);
  auto* const owned = slots + a.plan.frame_stride;  // frames whose node block is added here
  auto* const list = reinterpret_cast<const std::uint16_t*>(shared + a.plan.list);
  auto* const list_begin = reinterpret_cast<const std::uint16_t*>(shared + a.plan.list_begin);
  auto* const local = reinterpret_cast<const std::uint8_t*>(shared + a.plan.local);

  const int tid = static_cast<int>(threadIdx.x), threads = static_cast<int>(blockDim.x), P = a.tiles.tile_size;
  const int tile = static_cast<int>(blockIdx.x), stride = a.plan.frame_stride;
  const int first = a.tiles.tile_frame_begin[tile], frames = a.tiles.tile_frame_begin[tile + 1] - first;
  const auto all = static_cast<std::size_t>(a.tiles.frame_count);
  const TileHead& head = a.tiles.head[tile];
  const SharedPlan copies{a.plan.weights, a.plan.places, 0, 0, 0, a.plan.list, a.plan.list_begin, a.plan.local, 0, 0};
  copy_constants(a.tiles, copies, shared, tile);
  copy_lists(a.tiles, copies, shared, tile);

  const int lane = tid / Lanes, sub = tid % Lanes;
  const bool has_point = lane < P;
  // Where four threads take a point there are registers enough for it.
  constexpr bool kInRegisters = Lanes > 1;
  double own_point[kInRegisters ? kWords : 1];
  const double* const point =
      kInRegisters ? own_point : reinterpret_cast<double*>(shared + a.plan.point) + (has_point ? lane : 0);
  const double* const tile_points = a.points + static_cast<std::size_t>(tile) * kWords * P;
  if constexpr (kInRegisters) {
#pragma unroll
    for (int i = 0; i < kWords; ++i) own_point[i] = tile_points[i * P + (has_point ? lane : 0)];
  } else {
    copy_block(shared + a.plan.point, tile_points, kWords * P * 8);
  }
  const int material_number = a.tiles.material[static_cast<std::size_t>(tile) * P + (has_point ? lane : 0)];

  // Each thread takes one frame of the tile.
  double gamma_part = 0;
  const bool has_frame = tid < frames;
  const TileFrame own = has_frame ? a.tiles.tile_frames[first + tid] : TileFrame{};
  const int slot_begin = has_frame ? a.tiles.frame_slot_begin[own.frame] : 0;
  const int slot_end = has_frame ? a.tiles.frame_slot_begin[own.frame + 1] : 0;
  const unsigned held = has_frame && a.held != nullptr ? a.held[own.frame] : 0U;
  double* const row = rows + tid;
  if (has_frame) {
    const auto n = static_cast<std::size_t>(own.frame);
    double r[kDofs], z[kDofs]{}, pose[kPose];
    load_words<kPose>(a.pose + kPose * n, pose);
    load_words<kDofs>(a.b + kDofs * static_cast<std::size_t>(a.tiles.frame_node[own.frame]), r);
    clear_held(held, r);
#pragma unroll
    for (int i = 0; i < kPacked; ++i) inverse[i * stride + tid] = a.inverse[static_cast<std::size_t>(i) * all + n];
    add_packed(inverse + tid, static_cast<std::size_t>(stride), r, z);
    const double zero[kDofs]{};
    store_rows<kDofs>(row + kRowR * stride, stride, r);
    store_rows<kDofs>(row + kRowZ * stride, stride, z);
    store_rows<kDofs>(row + kRowS * stride, stride, zero);
    store_rows<kDofs>(row + kRowP * stride, stride, zero);
    store_rows<kDofs>(row + kRowX * stride, stride, zero);
    store_rows<kPose>(row + kRowPose * stride, stride, pose);
    write_direction(z, pose, head, records + kRecordStride * tid);
    slots[tid] = own.slot;
    owned[tid] = own.owner != 0 && a.node_blocks != nullptr ? own.frame : -1;
    if (own.owner != 0) gamma_part = dot6(r, z);
  }
  wait_copies();
  __syncthreads();

  CgState state = a.state;
  double gamma_old = 0, curvature_old = 0;
  for (int iteration = 0;; ++iteration) {
    const unsigned flag = static_cast<unsigned>(iteration) / 2 % 2;
    double* const partials = a.partials + static_cast<std::size_t>(iteration % 2) * kDofs * a.slot_count;
    double* const dots = a.dots + static_cast<std::size_t>(iteration % 2) * kReplicas * 2 * gridDim.x;

    if (lane < (P * Lanes + 31) / 32 * 32 / Lanes) {
      Mat3d tg, wA, dP, dW;
      const int q = has_point ? lane : 0;
      const Vec3d X{{places[q], places[P + q], places[2 * P + q]}};
      blend_frames<Lanes == 1 ? K : 0>(records, weights, local, P, a.tiles.influences, q, X, tg, wA, sub, Lanes);
#pragma unroll
      for (int step = 1; step < Lanes; step *= 2) {
#pragma unroll
        for (int i = 0; i < 9; ++i) {
          double& t = tg.m[i / 3][i % 3];
          double& w = wA.m[i / 3][i % 3];
          if constexpr (!Drilling) {
            if (step == 1) t += w;
            w = 0;
          } else {
            w += __shfl_xor_sync(0xffffffffU, w, step);
          }
          t += __shfl_xor_sync(0xffffffffU, t, step);
        }
      }
      const auto material = solid_material(a.tiles.materials[material_number], places[3 * P + q], state.inverse_step);
      stress_of_direction<Drilling>(point, kInRegisters ? 1 : P, material, state.tangent, tg, wA, head.blend, dP, dW);
      if (has_point && sub == 0) {
        store_matrix(stress + lane, P, dP);
        if constexpr (Drilling) store_matrix(stress + 9 * P + lane, P, dW);
      }
    }
    __syncthreads();

    double delta_part = 0;
    for (int base = 0; base < frames; base += threads / Gather) {
      const int f = base + tid / Gather;
      FrameSum sum;
      if (f < frames)
        gather_list<Drilling>(stress, weights, places, list, list_begin[f], list_begin[f + 1], P, tid % Gather, Gather,
                              sum);
      add_neighbours<Gather>(sum);
      if (f < frames && tid % Gather == 0) {
        const int slot = slots[f];
        double pose[kPose], y[kDofs], z[kDofs];
        load_rows<kPose>(rows + kRowPose * stride + f, stride, pose);
        load_rows<kDofs>(rows + kRowZ * stride + f, stride, z);
        finish_frame(sum, pose, head, y);
        if (owned[f] >= 0) add_packed(a.node_blocks + owned[f], all, z, y);
        double* to = partials + kDofs * slot;
#pragma unroll
        for (int i = 0; i < kDofs; i += 2) send(to + i, y[i], y[i + 1], flag);
        delta_part += dot6(y, z);
      }
    }
#pragma unroll
    for (int step = 16; step > 0; step /= 2) {
      gamma_part += __shfl_xor_sync(0xffffffffU, gamma_part, step);
      delta_part += __shfl_xor_sync(0xffffffffU, delta_part, step);
    }
    if (tid % 32 == 0) {
      scratch[tid / 16] = gamma_part;
      scratch[tid / 16 + 1] = delta_part;
    }
    __syncthreads();
    if (tid < kReplicas) {
      double gamma = 0, delta = 0;
      for (int w = 0; w < threads / 32; ++w) {
        gamma += scratch[2 * w];
        delta += scratch[2 * w + 1];
      }
      send(dots + 2 * (static_cast<int>(gridDim.x) * tid + tile), gamma, delta, flag);
    }
    double w[kDofs];
    receive_partials(partials, slot_begin, slot_end, flag, w);
    if (tid / 32 == threads / 32 - 1) {
      const double* replica = dots + 2 * static_cast<int>(gridDim.x) * (tile % kReplicas);
      const double2 all_dots = receive_dots(replica, static_cast<int>(gridDim.x), flag);
      if (tid % 32 == 0) *reinterpret_cast<double2*>(scratch + kSums) = all_dots;
    }
    __syncthreads();
    gamma_part = 0;
    const double2 sums = *reinterpret_cast<const double2*>(scratch + kSums);
    const double gamma = sums.x;
    state.iterations = iteration;
    state = judged(state, gamma);
    if (state.done != 0) break;
    const double beta = iteration > 0 ? gamma / gamma_old : 0.0;
    const double curvature = sums.y - beta * beta * curvature_old;
    double alpha = gamma / curvature;
    if (!(curvature > 0) || !isfinite(curvature)) {
      state.done = 1;
      state.status = static_cast<int>(isfinite(curvature) ? CgStatus::negative_curvature : CgStatus::not_finite);
      alpha = isfinite(curvature) && iteration == 0 ? 1.0 : 0.0;
      if (alpha == 0) break;
    }
    gamma_old = gamma;
    curvature_old = curvature;

    if (has_frame) {
      double r[kDofs], z[kDofs], s[kDofs], pose[kPose];
      clear_held(held, w);
      load_rows<kDofs>(row + kRowR * stride, stride, r);
      load_rows<kDofs>(row + kRowS * stride, stride, s);
      load_rows<kDofs>(row + kRowZ * stride, stride, z);
      if (own.owner != 0) {
        double p[kDofs], x[kDofs];
        load_rows<kDofs>(row + kRowP * stride, stride, p);
        load_rows<kDofs>(row + kRowX * stride, stride, x);
#pragma unroll
        for (int i = 0; i < kDofs; ++i) {
          p[i] = z[i] + beta * p[i];
          x[i] += alpha * p[i];
        }
        store_rows<kDofs>(row + kRowP * stride, stride, p);
        store_rows<kDofs>(row + kRowX * stride, stride, x);
      }
#pragma unroll
      for (int i = 0; i < kDofs; ++i) {
        s[i] = w[i] + beta * s[i];
        r[i] -= alpha * s[i];
        z[i] = 0;
      }
      add_packed(inverse + tid, static_cast<std::size_t>(stride), r, z);
      store_rows<kDofs>(row + kRowR * stride, stride, r);
      store_rows<kDofs>(row + kRowS * stride, stride, s);
      store_rows<kDofs>(row + kRowZ * stride, stride, z);
      load_rows<kPose>(row + kRowPose * stride, stride, pose);
      write_direction(z, pose, head, records + kRecordStride * tid);
      if (own.owner != 0) gamma_part = dot6(r, z);
    }
    if (state.done != 0) break;
    __syncthreads();
  }
  if (own.owner != 0) {
    double x[kDofs];
    load_rows<kDofs>(row + kRowX * stride, stride, x);
    store_words<kDofs>(a.solution + kDofs * static_cast<std::size_t>(a.tiles.frame_node[own.frame]), x);
  }
  if (blockIdx.x == 0 && tid == 0) *a.out = state;
}

}  // namespace fascia::tile
