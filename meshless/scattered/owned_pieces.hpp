#pragma once

#include "core/base/index.hpp"
#include "core/base/thread_pool.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace fascia {

/// Pieces by the chunks of a loop that take them: all pieces of an owner are taken by the same one, in their order, so
/// that sums over them have the same bits for any number of threads. That chunk holds the owner's first piece; where
/// pieces that are near one another in the list have few owners, it need not look far beyond its end.
class OwnedPieces {
 public:
  /// @param owner  of each piece, below `count`; −1: none. Must outlive this.
  OwnedPieces(std::span<const int> owner, std::size_t count)
      : owner_(owner), grain_(std::max(kFewest, owner.size() / kMostChunks + 1)), chunk_(count, kNone) {
    const std::size_t chunks = (owner.size() + grain_ - 1) / grain_;
    last_.resize(chunks);
    for (std::size_t c = 0; c < chunks; ++c)
      for (std::size_t p = c * grain_; p < std::min(owner.size(), (c + 1) * grain_); ++p) {
        if (owner[p] < 0) continue;
        std::uint32_t& home = chunk_[at(owner[p])];
        if (home == kNone) home = static_cast<std::uint32_t>(c);
        last_[home] = p;
      }
  }

  /// Calls act(piece, owner) for all pieces that have one.
  template <class Act>
  void for_each(ThreadPool& pool, const Act& act) const {
    pool.for_chunks(static_cast<int>(last_.size()), [&](int c) {
      const auto own = static_cast<std::uint32_t>(c);
      for (std::size_t p = own * grain_; p < std::max(last_[own] + 1, own * grain_); ++p)
        if (owner_[p] >= 0 && chunk_[at(owner_[p])] == own) act(p, at(owner_[p]));
    });
  }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  static constexpr std::size_t kFewest = 8192, kMostChunks = 64;

  std::span<const int> owner_;
  std::size_t grain_;                 ///< pieces of a chunk
  std::vector<std::uint32_t> chunk_;  ///< of each owner
  std::vector<std::size_t> last_;     ///< piece of each chunk
};

}  // namespace fascia
