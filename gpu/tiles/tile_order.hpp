#pragma once

#include <cstdint>
#include <span>
#include <vector>

/// Orders that keep neighbouring lanes on different banks of shared memory; results do not depend on them but for
/// rounding.
namespace fascia {

/// Permutes the influences of each point so that eight neighbouring lanes read frames of different number modulo 8, or
/// the same one, at each of them.
/// @param frames  (lanes × influences) frame of the tile
/// @param number  (lanes × influences) moved along; −1: unused, any place
void spread_influences(std::vector<std::uint8_t>& frames, std::vector<int>& number, int lanes, int influences);

/// Permutes each frame's entries so that at each step two lanes of each of eight neighbouring frames, which take
/// entries in turn, read different lanes modulo 16.
void spread_entries(std::span<std::vector<std::uint16_t>> lists);

}  // namespace fascia
