#include "gpu/tiles/tile_order.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <array>
#include <bitset>

namespace fascia {

namespace {

constexpr int kBanks = 8;       // of 16 bytes
constexpr int kNeighbours = 8;  // lanes that are served at once, and frames that list entries are gathered for at once
constexpr int kWordBanks = 16;  // of 8 bytes

}  // namespace

void spread_influences(std::vector<std::uint8_t>& frames, std::vector<int>& number, int lanes, int influences) {
  const std::size_t K = at(influences);
  std::vector<std::bitset<256>> taken(K);        // frames read at this influence
  std::vector<std::array<int, kBanks>> load(K);  // different ones of each bank
  std::vector<std::uint8_t> old_frames(K), new_frames(K);
  std::vector<int> old_number(K), new_number(K);
  for (int lane = 0; lane < lanes; ++lane) {
    if (lane % kNeighbours == 0) {
      for (auto& t : taken) t.reset();
      for (auto& l : load) l.fill(0);
    }
    const std::size_t base = at(lane) * K;
    std::copy_n(frames.begin() + static_cast<std::ptrdiff_t>(base), K, old_frames.begin());
    std::copy_n(number.begin() + static_cast<std::ptrdiff_t>(base), K, old_number.begin());
    std::vector<bool> used(K, false);
    for (std::size_t k = 0; k < K; ++k) {
      std::size_t best = K;
      int best_cost = 0;
      for (std::size_t i = 0; i < K; ++i) {
        if (used[i]) continue;
        const int cost = old_number[i] < 0 || taken[k][old_frames[i]] ? 0 : load[k][old_frames[i] % kBanks] + 1;
        if (best == K || cost < best_cost) {
          best = i;
          best_cost = cost;
        }
      }
      used[best] = true;
      new_frames[k] = old_frames[best];
      new_number[k] = old_number[best];
      if (new_number[k] >= 0 && !taken[k][new_frames[k]]) {
        taken[k].set(new_frames[k]);
        ++load[k][new_frames[k] % kBanks];
      }
    }
    std::copy_n(new_frames.begin(), K, frames.begin() + static_cast<std::ptrdiff_t>(base));
    std::copy_n(new_number.begin(), K, number.begin() + static_cast<std::ptrdiff_t>(base));
  }
}

void spread_entries(std::span<std::vector<std::uint16_t>> lists) {
  for (std::size_t first = 0; first < lists.size(); first += kNeighbours) {
    const auto group = lists.subspan(first, std::min<std::size_t>(kNeighbours, lists.size() - first));
    std::size_t longest = 0;
    for (const auto& l : group) longest = std::max(longest, l.size());
    for (std::size_t step = 0; step < longest; step += 2) {
      std::array<int, kWordBanks> load{};
      for (auto& l : group) {
        for (std::size_t place = step; place < std::min(step + 2, l.size()); ++place) {
          std::size_t best = place;
          for (std::size_t i = place + 1; i < l.size() && load[l[best] % kWordBanks] > 0; ++i)
            if (load[l[i] % kWordBanks] < load[l[best] % kWordBanks]) best = i;
          std::swap(l[place], l[best]);
          ++load[l[place] % kWordBanks];
        }
      }
    }
  }
}

}  // namespace fascia
