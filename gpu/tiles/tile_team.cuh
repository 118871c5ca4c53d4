#pragma once

#include "gpu/tiles/tile_device.cuh"
#include "gpu/tiles/tile_split.hpp"

/// How devices that compute one problem exchange rows and sums: each writes into the others' memory, and waits until
/// all have. A number travels in two words that carry the meeting's number beside a half of it, so that it needs no
/// flag. Sums are added by rank: every device knows the same.
namespace fascia::tile {

/// A device's place among those of a problem, and the memory of all of them.
struct TeamView {
  int rank = 0, size = 1;
  unsigned* meetings = nullptr;  ///< own: how many there were
  unsigned* arrived = nullptr;   ///< own: blocks of a launch that are done, 0 before and after
  /// Memory of each rank for what the others tell it: (2 × ranks × 2), even and odd meetings apart, as the next one may
  /// begin before all have read.
  std::uint64_t* words[kMostShares]{};
};

/// Rows of `words` numbers, an even number, that go to other ranks.
struct RowsArgs {
  int count = 0, words = 0;
  const TileExport* exports = nullptr;
  double* of[kMostShares]{};  ///< of each rank
};

/// Parts that are added up over all devices.
struct SumArgs {
  const double* parts = nullptr;  ///< null: none
  int count = 0;
  double* total = nullptr;
};

/// A device that does not come in so many cycles has failed: half a minute at least.
inline constexpr long long kPatience = 60'000'000'000;

__device__ inline void tell(std::uint64_t* words, double value, unsigned meeting) {
  const auto bits = static_cast<std::uint64_t>(__double_as_longlong(value));
  asm volatile("st.release.sys.global.u64 [%0], %1;" ::"l"(words), "l"(bits << 32 | meeting) : "memory");
  asm volatile("st.relaxed.sys.global.u64 [%0], %1;" ::"l"(words + 1), "l"(bits >> 32 << 32 | meeting) : "memory");
}
/// Waits for it.
__device__ inline double told(const std::uint64_t* words, unsigned meeting) {
  std::uint64_t word[2];
  const long long since = clock64();
  for (int i = 0; i < 2; ++i) {
    do {
      asm volatile("ld.acquire.sys.global.u64 %0, [%1];" : "=l"(word[i]) : "l"(words + i) : "memory");
      if (clock64() - since > kPatience) __trap();
    } while (static_cast<unsigned>(word[i]) != meeting);
  }
  return __longlong_as_double(static_cast<long long>(word[1] >> 32 << 32 | word[0] >> 32));
}

inline constexpr int kMeetThreads = 256;

/// The last block to finish its rows adds up the parts and meets the other ranks.
static __global__ __launch_bounds__(kMeetThreads) void meet_kernel(TeamView team, RowsArgs rows, SumArgs sum) {
  __shared__ double scratch[33], of_rank[kMostShares];
  __shared__ bool last;
  const int pairs = rows.words / 2, step = static_cast<int>(gridDim.x * blockDim.x);
  for (int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x); i < rows.count * pairs; i += step) {
    const TileExport e = rows.exports[i / pairs];
    const auto word = [&](int row) { return static_cast<std::size_t>(row) * rows.words + 2 * (i % pairs); };
    *reinterpret_cast<double2*>(rows.of[e.share] + word(e.remote_row)) =
        *reinterpret_cast<const double2*>(rows.of[team.rank] + word(e.row));
  }
  __syncthreads();
  if (threadIdx.x == 0) {
    __threadfence_system();  // what the block wrote, before its ticket
    last = gridDim.x == 1 || atomicInc(team.arrived, gridDim.x - 1) == gridDim.x - 1;
    __threadfence_system();
  }
  __syncthreads();
  if (!last) return;
  const double own = sum.parts != nullptr ? sum_of_blocks(sum.parts, sum.count, scratch) : 0.0;
  const int other = static_cast<int>(threadIdx.x);
  const unsigned now = *team.meetings + 1;
  const auto place = [&](int rank) { return 2 * (static_cast<int>(now % 2) * team.size + rank); };
  if (other < team.size) {
    tell(team.words[other] + place(team.rank), own, now);
    of_rank[other] = told(team.words[team.rank] + place(other), now);
  }
  __syncthreads();
  if (threadIdx.x != 0) return;
  double total = 0;
  for (int rank = 0; rank < team.size; ++rank) total += of_rank[rank];
  if (sum.total != nullptr) *sum.total = total;
  *team.meetings = now;
}

}  // namespace fascia::tile
