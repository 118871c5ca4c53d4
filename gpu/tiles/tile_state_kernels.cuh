#pragma once

#include "gpu/tiles/tile_kernels.cuh"

/// Kernels that run once a state: energies, forces, what a linearisation keeps, and the block-Jacobi preconditioner.
namespace fascia::tile {

/// Doubles of a frame's share in a gradient: force (3), N (9).
inline constexpr int kGradient = 12;

template <class Constant>
struct StateArgs {
  DeviceTiles<Constant> tiles;
  SharedPlan plan;
  const double* motion;  ///< (frames × 15) u, D by rows, rest position
  const double* E_old;   ///< (tiles × 6 × lanes) strain at the start of the step, or null
  double inverse_step;
  double* points;        ///< (tiles × words × lanes) H, S, Dbar; or null
  double* strain;        ///< (tiles × 6 × lanes) or null
  double* partials;      ///< (slots × 12) or null: no forces
  double* energy_parts;  ///< (3 × blocks): elastic, stabilisation, viscous
};

inline constexpr int kMotion = 16;  // with one word of padding

/// Energies, forces and what a linearisation keeps, each where it is asked for.
template <bool Drilling, class Constant>
__global__ __launch_bounds__(kMostTileThreads) void state_kernel(StateArgs<Constant> a) {
  extern __shared__ __align__(16) char shared[];
  constexpr int kWords = kPointWords<Drilling>;
  const int P = a.tiles.tile_size, threads = static_cast<int>(blockDim.x);
  constexpr Stabilization kTie = Drilling ? Stabilization::drilling : Stabilization::none;
  auto* const scratch = reinterpret_cast<double*>(shared + a.plan.scratch);
  const auto* const weights = reinterpret_cast<const Constant*>(shared + a.plan.weights);
  const auto* const places = reinterpret_cast<const Constant*>(shared + a.plan.places);
  auto* const point = reinterpret_cast<double*>(shared + a.plan.point);
  auto* const records = reinterpret_cast<double*>(shared + a.plan.records);
  const auto* const list = reinterpret_cast<const std::uint16_t*>(shared + a.plan.list);
  const auto* const list_begin = reinterpret_cast<const std::uint16_t*>(shared + a.plan.list_begin);
  const auto* const local = reinterpret_cast<const std::uint8_t*>(shared + a.plan.local);
  const int tid = static_cast<int>(threadIdx.x);

  PointEnergy<double> energy;
  for (int tile = static_cast<int>(blockIdx.x); tile < a.tiles.tile_count; tile += static_cast<int>(gridDim.x)) {
    const int first = a.tiles.tile_frame_begin[tile], frames = a.tiles.tile_frame_begin[tile + 1] - first;
    copy_constants(a.tiles, a.plan, shared, tile);
    copy_lists(a.tiles, a.plan, shared, tile);
    const TileHead head = a.tiles.head[tile];
    for (int f = tid; f < frames; f += threads) {
      const auto n = static_cast<std::size_t>(a.tiles.tile_frames[first + f].frame);
      double m[kMotion];
      load_words<kMotion>(a.motion + kMotion * n, m);
      Mat3d D;
      for (int i = 0; i < 9; ++i) D.m[i / 3][i % 3] = m[3 + i];
      write_record({{m[0], m[1], m[2]}}, D, m + 12, head, records + kRecordStride * f);
    }
    wait_copies();
    __syncthreads();
    if (tid < P) {
      const Vec3d X{{places[tid], places[P + tid], places[2 * P + tid]}};
      Mat3d tg, wA, E_old;
      blend_frames<0>(records, weights, local, P, a.tiles.influences, tid, X, tg, wA);
      const PointMotion<double> x{tg + wA, wA * (1 / head.blend)};
      const auto lane = static_cast<std::size_t>(tile) * P + tid;
      const auto material =
          solid_material(a.tiles.materials[a.tiles.material[lane]], places[3 * P + tid], a.inverse_step);
      const auto row = [&](int words) { return static_cast<std::size_t>(tile) * words * P + tid; };
      if (a.E_old != nullptr) E_old = load_symmetric(a.E_old + row(6), P);
      const auto s = point_stress<kTie>(x, material, E_old);
      if (a.points != nullptr) {
        store_matrix(a.points + row(kWords), P, x.H);
        store_symmetric(a.points + row(kWords) + 9 * P, P, s.S);
        if constexpr (Drilling) store_matrix(a.points + row(kWords) + 15 * P, P, x.Dbar);
      }
      if (a.strain != nullptr) store_symmetric(a.strain + row(6), P, green_strain(x.H));
      if (a.energy_parts != nullptr) {
        const auto e = point_energy<kTie>(x, material, E_old);
        energy.elastic += e.elastic;
        energy.stabilization += e.stabilization;
        energy.viscous += e.viscous;
      }
      store_matrix(point + tid, P, s.P * material.volume);
      if constexpr (Drilling) store_matrix(point + 9 * P + tid, P, (s.P + s.Y * (1 / head.blend)) * material.volume);
    }
    __syncthreads();
    for (int base = 0; base < frames && a.partials != nullptr; base += threads / 2) {
      const int f = base + tid / 2;
      FrameSum sum;
      if (f < frames)
        gather_list<Drilling>(point, weights, places, list, list_begin[f], list_begin[f + 1], P, tid % 2, 2, sum);
      add_neighbours<2>(sum);
      if (f < frames && tid % 2 == 0) {
        const TileFrame frame = a.tiles.tile_frames[first + f];
        const Mat3d N = conjugate_of(sum, a.motion + kMotion * static_cast<std::size_t>(frame.frame) + 12, head);
        double* out = a.partials + kGradient * static_cast<std::size_t>(frame.slot);
        for (int i = 0; i < 3; ++i) out[i] = sum.f[i];
        for (int i = 0; i < 9; ++i) out[3 + i] = N.m[i / 3][i % 3];
      }
    }
    __syncthreads();
  }
  if (a.energy_parts == nullptr) return;
  const double terms[3] = {energy.elastic, energy.stabilization, energy.viscous};
  for (int k = 0; k < 3; ++k) {
    const double part = block_sum(terms[k], scratch);
    if (tid == 0) a.energy_parts[k * static_cast<int>(gridDim.x) + static_cast<int>(blockIdx.x)] = part;
    __syncthreads();
  }
}

/// Poses and motions of frames from those of nodes.
/// @param u     (nodes × 3)
/// @param D     (nodes × 9) Q − I by rows
/// @param rest  (frames × 3)
static __global__ void pose_kernel(int frame_count, const int* frame_node, const double* rest, const double* u,
                                   const double* D, double* motion, double* pose) {
  const int f = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (f >= frame_count) return;
  const int node = frame_node[f];
  double* m = motion + static_cast<std::size_t>(kMotion) * static_cast<std::size_t>(f);
  double* q = pose + static_cast<std::size_t>(kPose) * static_cast<std::size_t>(f);
  for (int i = 0; i < 3; ++i) {
    m[i] = u[3 * static_cast<std::size_t>(node) + i];
    m[12 + i] = q[9 + i] = rest[3 * static_cast<std::size_t>(f) + i];
  }
  for (int i = 0; i < 9; ++i) {
    const double d = D[9 * static_cast<std::size_t>(node) + i];
    m[3 + i] = d;
    q[i] = d + (i % 4 == 0 ? 1.0 : 0.0);
  }
  m[15] = 0;
}

/// Gradient by node (6) and, where asked for, N (9 by rows) of each.
static __global__ void gradient_kernel(int frame_count, const int* frame_node, const int* frame_slot_begin,
                                       const double* partials, const double* pose, double* gradient, double* moments) {
  const int f = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (f >= frame_count) return;
  FrameSum sum;
  for (int slot = frame_slot_begin[f]; slot < frame_slot_begin[f + 1]; ++slot) {
    const double* part = partials + kGradient * static_cast<std::size_t>(slot);
    for (int i = 0; i < 3; ++i) sum.f[i] += part[i];
    for (int i = 0; i < 9; ++i) sum.M.m[i / 3][i % 3] += part[3 + i];
  }
  const auto node = static_cast<std::size_t>(frame_node[f]);
  Mat3d Q;
  for (int i = 0; i < 9; ++i)
    Q.m[i / 3][i % 3] = pose[static_cast<std::size_t>(kPose) * static_cast<std::size_t>(f) + i];
  const Vec3d torque = axl(times_transpose(Q, sum.M));
  for (int i = 0; i < 3; ++i) {
    gradient[kDofs * node + i] = sum.f[i];
    gradient[kDofs * node + 3 + i] = torque[i];
  }
  if (moments != nullptr)
    for (int i = 0; i < 9; ++i) moments[9 * node + i] = sum.M.m[i / 3][i % 3];
}

/// The symmetric parts of (6 × 6) blocks by node, packed by frame.
static __global__ void pack_blocks_kernel(int frame_count, const int* frame_node, const double* blocks,
                                          double* packed) {
  const int f = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (f >= frame_count) return;
  const double* B = blocks + 36 * static_cast<std::size_t>(frame_node[f]);
  int n = 0;
  for (int i = 0; i < kDofs; ++i)
    for (int j = i; j < kDofs; ++j)
      packed[static_cast<std::size_t>(n++) * static_cast<std::size_t>(frame_count) + static_cast<std::size_t>(f)] =
          0.5 * (B[kDofs * i + j] + B[kDofs * j + i]);
}

/// The inverse of a symmetric block, as positive_inverse(): by L D Lᵀ with pivots kept positive.
/// @param a  lower triangle is read
/// @param write  write(i, j, value) for j ≥ i
template <class Write>
__device__ inline void invert_positive(double (&a)[kDofs][kDofs], const Write& write) {
  double largest = 0;
#pragma unroll
  for (int i = 0; i < kDofs; ++i) largest = fmax(largest, fabs(a[i][i]));
  if (largest == 0) largest = 1;
  double d[kDofs];
#pragma unroll
  for (int j = 0; j < kDofs; ++j) {
    d[j] = a[j][j];
#pragma unroll
    for (int k = 0; k < j; ++k) d[j] -= a[j][k] * a[j][k] * d[k];
    d[j] = fmax(fabs(d[j]), 1e-12 * largest);
#pragma unroll
    for (int i = j + 1; i < kDofs; ++i) {
      double sum = a[i][j];
#pragma unroll
      for (int k = 0; k < j; ++k) sum -= a[i][k] * a[j][k] * d[k];
      a[i][j] = sum / d[j];
    }
  }
#pragma unroll
  for (int column = 0; column < kDofs; ++column) {
    double x[kDofs];
#pragma unroll
    for (int i = 0; i < kDofs; ++i) {
      x[i] = i == column ? 1.0 : 0.0;
#pragma unroll
      for (int k = 0; k < i; ++k) x[i] -= a[i][k] * x[k];
    }
#pragma unroll
    for (int i = kDofs - 1; i >= 0; --i) {
      x[i] /= d[i];
#pragma unroll
      for (int k = i + 1; k < kDofs; ++k) x[i] -= a[k][i] * x[k];
    }
#pragma unroll
    for (int i = 0; i <= column; ++i) write(i, column, x[i]);
  }
}

inline constexpr int kJacobiLanes = 8;  // six of them take one column of a frame's block each
inline constexpr int kJacobiFrames = 16;

inline constexpr int kBlock = kDofs * kDofs;

struct JacobiArgs {
  const std::uint8_t* held;  ///< (frames) bits, or null
  Tangent tangent;
  double inverse_step;
  int owned;                ///< frames whose node blocks are added
  float* inverse;           ///< (21 × frames)
  const int* shared_place;  ///< (frames) row of `blocks` that takes a frame's own block, −1: none; or null: of none
  double* blocks;           ///< (rows × 36) of frames that other devices compute too
};

/// The inverse of a block whose held rows and columns are those of the identity, packed.
__device__ inline void write_inverse(double (&block)[kDofs][kDofs], int frame, std::size_t frames,
                                     const JacobiArgs& args) {
  const unsigned mask = args.held == nullptr ? 0U : args.held[frame];
#pragma unroll
  for (int i = 0; i < kDofs; ++i) {
#pragma unroll
    for (int j = 0; j < kDofs; ++j)
      if ((mask >> i & 1U) != 0 || (mask >> j & 1U) != 0) block[i][j] = i == j ? 1.0 : 0.0;
  }
  invert_positive(block, [&](int i, int j, double value) {
    const int n = i * kDofs - i * (i - 1) / 2 + (j - i);
    args.inverse[static_cast<std::size_t>(n) * frames + static_cast<std::size_t>(frame)] = static_cast<float>(value);
  });
}

/// Inverse of each frame's own block, packed. Points are read straight from memory: their tiles are not kept on chip.
template <bool Drilling, class Constant>
__global__ __launch_bounds__(kJacobiLanes* kJacobiFrames) void jacobi_kernel(ProductArgs<Constant> a, JacobiArgs args) {
  __shared__ double blocks[kJacobiFrames][kDofs][kDofs + 1];
  constexpr int kWords = kPointWords<Drilling>;
  const int column = static_cast<int>(threadIdx.x) % kJacobiLanes, own = static_cast<int>(threadIdx.x) / kJacobiLanes;
  const int f = static_cast<int>(blockIdx.x) * kJacobiFrames + own, P = a.tiles.tile_size, K = a.tiles.influences;
  const auto frames = static_cast<std::size_t>(a.tiles.frame_count);
  if (f < a.tiles.frame_count && column < kDofs) {
    double pose[kPose], direction[kDofs], y[kDofs]{};
    load_words<kPose>(a.pose + kPose * static_cast<std::size_t>(f), pose);
    for (int i = 0; i < kDofs; ++i) direction[i] = i == column ? 1.0 : 0.0;
    for (int slot = a.tiles.frame_slot_begin[f]; slot < a.tiles.frame_slot_begin[f + 1]; ++slot) {
      const int tile = a.tiles.slot_tile[slot];
      if (tile < 0) continue;  // another device's
      const int local = a.tiles.slot_tile_frame[slot] - a.tiles.tile_frame_begin[tile];
      const auto t = static_cast<std::size_t>(tile);
      const TileHead head = a.tiles.head[tile];
      const std::uint16_t* begin = a.tiles.list_begin + t * a.tiles.list_stride + local;
      double record[kRecord];
      write_direction(direction, pose, head, record);
      FrameSum sum;
      for (int e = begin[0]; e < begin[1]; ++e) {
        const int entry = a.tiles.list[t * K * P + e], lane = entry & ((1 << kTileLaneBits) - 1);
        const Constant* weights = a.tiles.weights + (t * K + (entry >> kTileLaneBits)) * 4 * P + lane;
        const Constant* places = a.tiles.places + t * 4 * P + lane;
        const double w = weights[0];
        const Vec3d g{{weights[P], weights[2 * P], weights[3 * P]}}, X{{places[0], places[P], places[2 * P]}};
        Vec3d motion;
        Mat3d A, dP, dW;
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) A(i, j) = record[3 + 3 * i + j];
          motion[i] = record[i] + dot(A.row(i), X);
        }
        const auto material =
            solid_material(a.tiles.materials[a.tiles.material[t * P + lane]], places[3 * P], args.inverse_step);
        stress_of_direction<Drilling>(a.points + t * kWords * P + lane, P, material, args.tangent, outer(motion, g),
                                      A * w, head.blend, dP, dW);
        const Vec3d h = dP * g;
        sum.f += h;
        sum.M += outer(h, X) + (Drilling ? dW : dP) * w;
      }
      double part[kDofs];
      finish_frame(sum, pose, head, part);
      for (int i = 0; i < kDofs; ++i) y[i] += part[i];
    }
    if (a.node_blocks != nullptr && f < args.owned) add_packed(a.node_blocks + f, frames, direction, y);
    for (int i = 0; i < kDofs; ++i) blocks[own][i][column] = y[i];
  }
  __syncthreads();
  if (f >= a.tiles.frame_count || column != 0) return;
  const int place = args.shared_place == nullptr ? -1 : args.shared_place[f];
  double block[kDofs][kDofs];
#pragma unroll
  for (int i = 0; i < kDofs; ++i) {
#pragma unroll
    for (int j = 0; j < kDofs; ++j) block[i][j] = blocks[own][i][j];
  }
  if (place < 0) {
    write_inverse(block, f, frames, args);
    return;
  }
  for (int i = 0; i < kBlock; ++i)
    args.blocks[static_cast<std::size_t>(kBlock) * place + i] = block[i / kDofs][i % kDofs];
}

/// Inverse of the own block of each frame that several devices compute, packed, from the parts of each.
/// @param block_begin  (count + 1) rows of a frame, by rank
static __global__ __launch_bounds__(kUpdateThreads) void shared_jacobi_kernel(int count, const int* shared,
                                                                              const int* block_begin, int frames,
                                                                              JacobiArgs args) {
  const int s = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (s >= count) return;
  double block[kDofs][kDofs]{};
  for (int row = block_begin[s]; row < block_begin[s + 1]; ++row) {
    const double* part = args.blocks + static_cast<std::size_t>(kBlock) * row;
#pragma unroll
    for (int i = 0; i < kBlock; ++i) block[i / kDofs][i % kDofs] += part[i];
  }
  write_inverse(block, shared[s], static_cast<std::size_t>(frames), args);
}

}  // namespace fascia::tile
