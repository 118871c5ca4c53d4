#pragma once

#include "gpu/space/device.hpp"
#include "gpu/tiles/tile_solver_cg.cuh"
#include "gpu/tiles/tile_team_solver.cuh"

#include <algorithm>

/// A solver as one of several.
namespace fascia::tile {

template <class Constant>
void Solver<Constant>::join(std::span<const std::unique_ptr<Solver>> team, int rank) {
  const auto ranks = static_cast<int>(team.size());
  team_.rank = rank;
  team_.size = ranks;
  for (const auto& member : team) members_.push_back(member.get());
  partial_exports_.upload(share_.partials);
  block_exports_.upload(share_.blocks);
  shared_.upload(share_.shared);
  shared_block_begin_.upload(share_.shared_block_begin);
  std::vector<int> place(at(layout_.frame_count), -1);
  for (std::size_t i = 0; i < share_.shared.size(); ++i) place[at(share_.shared[i])] = share_.own_block[i];
  shared_place_.upload(place);
  blocks_.resize(kBlock * at(share_.shared_block_begin.back()));
  sums_.resize(2);
  words_.upload(std::vector<std::uint64_t>(4 * at(ranks)));
  meetings_.upload(std::vector<unsigned>(1));
  arrived_.upload(std::vector<unsigned>(1));
  // A kernel that is loaded when it is first launched waits for the device, which may be waiting for another one.
  for (const void* kernel :
       {reinterpret_cast<const void*>(meet_kernel), reinterpret_cast<const void*>(gather_kernel),
        reinterpret_cast<const void*>(gradient_kernel), reinterpret_cast<const void*>(start_kernel),
        reinterpret_cast<const void*>(finish_kernel), reinterpret_cast<const void*>(pose_kernel),
        reinterpret_cast<const void*>(order_kernel), reinterpret_cast<const void*>(jacobi_),
        reinterpret_cast<const void*>(pack_blocks_kernel), reinterpret_cast<const void*>(shared_jacobi_kernel)}) {
    cudaFuncAttributes loaded{};
    check(cudaFuncGetAttributes(&loaded, kernel), "loading a kernel");
  }
  team_.meetings = meetings_.get();
  team_.arrived = arrived_.get();
  wait_for_copies();
}

template <class Constant>
void Solver<Constant>::meet(const RowsArgs& rows, const SumArgs& sum, cudaStream_t stream) {
  if (alone()) return;
  for (int rank = 0; rank < team_.size; ++rank) team_.words[rank] = members_[at(rank)]->words_.get();
  constexpr int kMostBlocks = 264;
  const int blocks = std::clamp((rows.count * rows.words / 2 + kMeetThreads - 1) / kMeetThreads, 1, kMostBlocks);
  meet_kernel<<<blocks, kMeetThreads, 0, stream>>>(team_, rows, sum);
  check(cudaGetLastError(), "meeting the other GPUs");
}

template <class Constant>
RowsArgs Solver<Constant>::rows_of(const Buffer<TileExport>& exports, int words, Buffer<double> Solver::*rows) const {
  RowsArgs args;
  args.count = static_cast<int>(exports.size());
  args.words = words;
  args.exports = exports.get();
  for (std::size_t rank = 0; rank < members_.size(); ++rank) args.of[rank] = (members_[rank]->*rows).get();
  return args;
}

template <class Constant>
TeamSolver<Constant>::TeamSolver(TileLayout layout, std::span<const int> devices)
    : devices_(devices.begin(), devices.end()) {
  if (at(layout.tile_count) < devices_.size()) throw gpu::NotShared("the model has too few points for so many GPUs");
  connect_devices(devices_);
  std::vector<TileShare> shares = split_tiles(layout, static_cast<int>(devices_.size()));
  layout = {};
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    const OnDevice on(devices_[i]);
    streams_.push_back(std::make_unique<TeamStream>(devices_[i]));
    ranks_.push_back(
        std::make_unique<Ranked>(std::move(shares[i]), std::nullopt, DeviceLimits::present(), streams_[i]->get()));
  }
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    const OnDevice on(devices_[i]);
    ranks_[i]->join(ranks_, static_cast<int>(i));
  }
  const OnDevice on(devices_[0]);
  check(cudaEventCreateWithFlags(&start_, cudaEventDisableTiming), "making an event");
}

template <class Constant>
TeamSolver<Constant>::~TeamSolver() {
  for (std::size_t i = 0; i < ranks_.size(); ++i) cudaStreamSynchronize(streams_[i]->get());
  if (start_ != nullptr) cudaEventDestroy(start_);
}

}  // namespace fascia::tile
