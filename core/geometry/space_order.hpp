#pragma once

#include "core/geometry/bounds.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace fascia {

/// Places in an order in which neighbours are near each other: by ten bits of each coordinate, interleaved (Morton).
/// @param cells  along the longest axis, up to 1023; not a whole number where places may lie at simple fractions of it,
///               which rounding would put on either side of a border
inline std::vector<std::size_t> order_in_space(std::span<const Vec3d> places, double cells = 1023) {
  const Bounds bounds = bounds_of(places);
  const double size = bounds.diagonal() > 0 ? bounds.extent()[longest_axis(bounds)] : 1.0;
  std::vector<std::pair<std::uint32_t, std::size_t>> keys;
  keys.reserve(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3d x = (places[i] - bounds.low) * (1 / size);
    std::uint32_t code = 0;
    for (int bit = 9; bit >= 0; --bit)
      for (int a = 0; a < 3; ++a) code = code * 2 + (static_cast<std::uint32_t>(x[a] * cells) >> bit & 1U);
    keys.emplace_back(code, i);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::size_t> order;
  order.reserve(keys.size());
  for (const auto& [key, i] : keys) order.push_back(i);
  return order;
}

}  // namespace fascia
