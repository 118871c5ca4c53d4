#pragma once

#include "core/physics/point_physics.hpp"
#include "gpu/tiles/tile_layout.hpp"

#include <cuda_runtime.h>

/// Thread functions for a tile's frames, points and lists. A frame's motion travels as twelve numbers c, A with
///   t = c + A X,   H = Σ t gᵀ + w A,   blended rotation = Σ w A / blend,
/// places relative to the tile's origin; forces return the same way: h = P g,  f = Σ h,  M = Σ h Xᵀ + w (P + Y /
/// blend).
namespace fascia::tile {

/// Doubles of a frame's record and of a pose: Q − I or Q by rows (9), rest position (3).
inline constexpr int kRecord = 12;
inline constexpr int kRecordStride = 14;  // an odd number of 16-byte words: neighbours on different banks
inline constexpr int kPose = 12;
inline constexpr int kDofs = 6;
inline constexpr int kPacked = 21;  // upper triangle of a 6 × 6 block, by rows

/// Constants of a tiled point set on the device; pointers as in TileLayout.
template <class Constant>
struct DeviceTiles {
  int tile_size, influences, tile_count, frame_count, list_stride;
  const Constant* weights;
  const Constant* places;
  const std::uint16_t* material;
  const std::uint8_t* local;
  const std::uint16_t* list;
  const std::uint16_t* list_begin;
  const int* tile_frame_begin;
  const TileFrame* tile_frames;
  const TileHead* head;
  const TileMaterial* materials;
  const int* frame_node;
  const int* frame_slot_begin;
  const int* slot_tile;
  const int* slot_tile_frame;
};

/// Words that a point keeps of a state: H (9), S (6), with drilling Dbar (9).
template <bool Drilling>
inline constexpr int kPointWords = Drilling ? 24 : 15;

/// Words of a point's stress: P (9), with drilling also Y / blend (9).
template <bool Drilling>
inline constexpr int kStressWords = Drilling ? 18 : 9;

__device__ inline void copy_async(void* shared, const void* global) {
  asm volatile(
      "cp.async.cg.shared.global [%0], [%1], 16;" ::"r"(static_cast<unsigned>(__cvta_generic_to_shared(shared))),
      "l"(global));
}
__device__ inline void wait_copies() { asm volatile("cp.async.commit_group;\ncp.async.wait_group 0;" ::: "memory"); }

/// All threads of the block copy `bytes`, a multiple of 16, which wait_copies() and a barrier complete.
__device__ inline void copy_block(void* shared, const void* global, int bytes) {
  for (int i = 16 * static_cast<int>(threadIdx.x); i < bytes; i += 16 * static_cast<int>(blockDim.x))
    copy_async(static_cast<char*>(shared) + i, static_cast<const char*>(global) + i);
}

/// N 16-byte aligned doubles.
template <int N>
__device__ inline void load_words(const double* from, double* to) {
#pragma unroll
  for (int i = 0; i < N; i += 2) {
    const double2 two = *reinterpret_cast<const double2*>(from + i);
    to[i] = two.x;
    to[i + 1] = two.y;
  }
}
template <int N>
__device__ inline void store_words(double* to, const double* from) {
#pragma unroll
  for (int i = 0; i < N; i += 2) *reinterpret_cast<double2*>(to + i) = make_double2(from[i], from[i + 1]);
}

/// c and A of a frame that moves by t and dQ.
__device__ inline void write_record(const Vec3d& t, const Mat3d& dQ, const double* rest, const TileHead& head,
                                    double* record) {
  double r[kRecord];
  const Mat3d A = dQ * head.blend;
  const Vec3d arm{{rest[0] - head.origin[0], rest[1] - head.origin[1], rest[2] - head.origin[2]}};
  const Vec3d c = t - A * arm;
#pragma unroll
  for (int i = 0; i < 3; ++i) {
    r[i] = c[i];
#pragma unroll
    for (int j = 0; j < 3; ++j) r[3 + 3 * i + j] = A(i, j);
  }
  store_words<kRecord>(record, r);
}

/// Writes c and A of a frame that moves along v: dx (3), rotation vector (3).
__device__ inline void write_direction(const double* v, const double* pose, const TileHead& head, double* record) {
  Mat3d Q;
#pragma unroll
  for (int i = 0; i < 9; ++i) Q.m[i / 3][i % 3] = pose[i];
  write_record({{v[0], v[1], v[2]}}, skew(Vec3d{{v[3], v[4], v[5]}}) * Q, pose + 9, head, record);
}

/// Σ t gᵀ and Σ w A over a point's influences, those from `first` in steps.
/// @param K  influences, 0: as many as `influences` says
template <int K, class Constant>
__device__ inline void blend_frames(const double* records, const Constant* weights, const std::uint8_t* local,
                                    int lanes, int influences, int lane, const Vec3d& X, Mat3d& tg, Mat3d& wA,
                                    int first = 0, int step = 1) {
  const int n = K > 0 ? K : influences;
#pragma unroll(K > 0 && K <= 8 ? K : 1)
  for (int k = first; k < n; k += step) {
    double r[kRecord];
    load_words<kRecord>(records + kRecordStride * local[k * lanes + lane], r);
    const Constant* at_k = weights + k * 4 * lanes + lane;
    const double w = at_k[0], g[3] = {at_k[lanes], at_k[2 * lanes], at_k[3 * lanes]};
#pragma unroll
    for (int i = 0; i < 3; ++i) {
      const double t = r[i] + r[3 + 3 * i] * X[0] + r[4 + 3 * i] * X[1] + r[5 + 3 * i] * X[2];
#pragma unroll
      for (int j = 0; j < 3; ++j) {
        tg(i, j) += t * g[j];
        wA(i, j) += w * r[3 + 3 * i + j];
      }
    }
  }
}

/// Moment sums of a frame over its list: f (3) and M (9).
struct FrameSum {
  Vec3d f{};
  Mat3d M{};
};

/// Adds entries `first`, `first + step`, … of a list.
/// @param stress  (9 or 18 × lanes) P, with drilling also P + Y / blend
template <bool Drilling, class Constant>
__device__ inline void gather_list(const double* stress, const Constant* weights, const Constant* places,
                                   const std::uint16_t* list, int begin, int end, int lanes, int first, int step,
                                   FrameSum& sum) {
  int next = begin + first < end ? list[begin + first] : 0;
  for (int e = begin + first; e < end; e += step) {
    const int entry = next;
    next = e + step < end ? list[e + step] : 0;
    const int lane = entry & ((1 << kTileLaneBits) - 1), k = entry >> kTileLaneBits;
    const Constant* at_k = weights + k * 4 * lanes + lane;
    const double w = at_k[0];
    const Vec3d g{{at_k[lanes], at_k[2 * lanes], at_k[3 * lanes]}};
    const Vec3d X{{places[lane], places[lanes + lane], places[2 * lanes + lane]}};
#pragma unroll
    for (int i = 0; i < 3; ++i) {
      double P[3];
#pragma unroll
      for (int j = 0; j < 3; ++j) P[j] = stress[(3 * i + j) * lanes + lane];
      const double h = P[0] * g[0] + P[1] * g[1] + P[2] * g[2];
      sum.f[i] += h;
#pragma unroll
      for (int j = 0; j < 3; ++j)
        sum.M(i, j) += h * X[j] + w * (Drilling ? stress[(9 + 3 * i + j) * lanes + lane] : P[j]);
    }
  }
}

/// Adds up what `lanes` neighbouring threads gathered; each then holds the sum.
template <int Lanes>
__device__ inline void add_neighbours(FrameSum& sum) {
#pragma unroll
  for (int step = 1; step < Lanes; step *= 2) {
#pragma unroll
    for (int i = 0; i < 3; ++i) {
      sum.f[i] += __shfl_xor_sync(0xffffffffU, sum.f[i], step);
#pragma unroll
      for (int j = 0; j < 3; ++j) sum.M(i, j) += __shfl_xor_sync(0xffffffffU, sum.M(i, j), step);
    }
  }
}

/// N, conjugate to Q: c (M − f (x − origin)ᵀ).
__device__ inline Mat3d conjugate_of(const FrameSum& sum, const double* rest, const TileHead& head) {
  const Vec3d arm{{rest[0] - head.origin[0], rest[1] - head.origin[1], rest[2] - head.origin[2]}};
  return (sum.M - outer(sum.f, arm)) * head.blend;
}

/// Force (3) and torque (3) of a frame.
__device__ inline void finish_frame(const FrameSum& sum, const double* pose, const TileHead& head, double* out) {
  const Mat3d N = conjugate_of(sum, pose + 9, head);
  Mat3d Q;
#pragma unroll
  for (int i = 0; i < 9; ++i) Q.m[i / 3][i % 3] = pose[i];
  const Vec3d torque = axl(times_transpose(Q, N));
#pragma unroll
  for (int i = 0; i < 3; ++i) {
    out[i] = sum.f[i];
    out[3 + i] = torque[i];
  }
}

__device__ inline SolidMaterial<Law::st_venant_kirchhoff, double> solid_material(const TileMaterial& m, double volume,
                                                                                 double inverse_step) {
  SolidMaterial<Law::st_venant_kirchhoff, double> r;
  r.volume = volume;
  r.lambda = m.lambda;
  r.mu = m.mu;
  r.stabilization = m.stabilization;
  r.viscosity = m.stiffness_damping * inverse_step;
  return r;
}

/// Where a matrix or a symmetric one (11 22 33 23 13 12) stands in rows of lanes.
__device__ inline Mat3d load_matrix(const double* rows, int lanes) {
  Mat3d m;
#pragma unroll
  for (int i = 0; i < 9; ++i) m.m[i / 3][i % 3] = rows[i * lanes];
  return m;
}
__device__ inline void store_matrix(double* rows, int lanes, const Mat3d& m) {
#pragma unroll
  for (int i = 0; i < 9; ++i) rows[i * lanes] = m.m[i / 3][i % 3];
}
__device__ inline Mat3d load_symmetric(const double* rows, int lanes) {
  Mat3d m;
  m(0, 0) = rows[0];
  m(1, 1) = rows[lanes];
  m(2, 2) = rows[2 * lanes];
  m(1, 2) = m(2, 1) = rows[3 * lanes];
  m(0, 2) = m(2, 0) = rows[4 * lanes];
  m(0, 1) = m(1, 0) = rows[5 * lanes];
  return m;
}
__device__ inline void store_symmetric(double* rows, int lanes, const Mat3d& m) {
  rows[0] = m(0, 0);
  rows[lanes] = m(1, 1);
  rows[2 * lanes] = m(2, 2);
  rows[3 * lanes] = m(1, 2);
  rows[4 * lanes] = m(0, 2);
  rows[5 * lanes] = m(0, 1);
}

/// v dP and, with drilling, v (dP + dY / blend) of a direction at the state of a point.
/// @param state  rows of the point: H, S, with drilling Dbar
template <bool Drilling>
__device__ inline void stress_of_direction(const double* state, int lanes,
                                           const SolidMaterial<Law::st_venant_kirchhoff, double>& material,
                                           Tangent tangent, const Mat3d& tg, const Mat3d& wA, double blend, Mat3d& dP,
                                           Mat3d& dW) {
  constexpr Stabilization kTie = Drilling ? Stabilization::drilling : Stabilization::none;
  PointMotion<double> x;
  x.H = load_matrix(state, lanes);
  TangentStress<double> s{load_symmetric(state + 9 * lanes, lanes), {}};
  if constexpr (Drilling) {
    x.Dbar = load_matrix(state + 15 * lanes, lanes);
    s.drilling = drilling_axis(drilling_motion(x), material.stabilization);
  }
  const auto d =
      point_stress_differential<kTie>(x, s, material, tangent, {tg + wA, Drilling ? wA * (1 / blend) : Mat3d{}});
  dP = d.dP * material.volume;
  if constexpr (Drilling) dW = dP + d.dY * (material.volume / blend);
}

/// y += B x with B packed by rows of its upper triangle, entries `stride` apart.
template <class T>
__device__ inline void add_packed(const T* B, std::size_t stride, const double* x, double* y) {
  int n = 0;
#pragma unroll
  for (int i = 0; i < kDofs; ++i) {
#pragma unroll
    for (int j = i; j < kDofs; ++j) {
      const double b = B[stride * static_cast<std::size_t>(n++)];
      y[i] += b * x[j];
      if (j > i) y[j] += b * x[i];
    }
  }
}

__device__ inline double dot6(const double* a, const double* b) {
  double sum = 0;
#pragma unroll
  for (int i = 0; i < kDofs; ++i) sum += a[i] * b[i];
  return sum;
}

/// The sum over the block in a fixed order, in thread 0.
/// @param scratch  32 doubles in shared memory, free at the call
__device__ inline double block_sum(double value, double* scratch) {
#pragma unroll
  for (int step = 16; step > 0; step /= 2) value += __shfl_xor_sync(0xffffffffU, value, step);
  if (threadIdx.x % 32 == 0) scratch[threadIdx.x / 32] = value;
  __syncthreads();
  double sum = 0;
  if (threadIdx.x == 0)
    for (unsigned w = 0; w < blockDim.x / 32; ++w) sum += scratch[w];
  return sum;
}

/// The sum of an array that every thread of every block of a launch gets alike.
/// @param scratch  33 doubles in shared memory
__device__ inline double sum_of_blocks(const double* parts, int count, double* scratch) {
  double value = 0;
  for (int i = static_cast<int>(threadIdx.x); i < count; i += static_cast<int>(blockDim.x)) value += parts[i];
  const double sum = block_sum(value, scratch);
  if (threadIdx.x == 0) scratch[32] = sum;
  __syncthreads();
  const double result = scratch[32];
  __syncthreads();
  return result;
}

}  // namespace fascia::tile
