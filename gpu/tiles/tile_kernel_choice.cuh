#pragma once

#include "gpu/tiles/tile_resident.cuh"

#include <algorithm>

/// Which instance of a kernel computes tiles of a size.
namespace fascia::tile {

template <bool Drilling, class Constant>
auto choose_product(int influences, int tile_size) -> void (*)(ProductArgs<Constant>) {
  if (influences == 4 && tile_size == 256) return product_kernel<4, 256, Drilling, Constant>;
  if (influences == 4 && tile_size == 128) return product_kernel<4, 128, Drilling, Constant>;
  if (influences == 8 && tile_size == 256) return product_kernel<8, 256, Drilling, Constant>;
  if (influences == 8 && tile_size == 128) return product_kernel<8, 128, Drilling, Constant>;
  if (tile_size == 128) return product_kernel<0, 128, Drilling, Constant>;
  return product_kernel<0, 0, Drilling, Constant>;
}

template <class Constant>
struct ResidentChoice {
  void (*kernel)(ResidentArgs<Constant>) = nullptr;
  int threads = 0;
};

/// Four threads take a point where tiles are so small that the chain of one would be long.
/// @param frames  of a tile at most
template <bool Drilling, class Constant>
ResidentChoice<Constant> choose_resident(int influences, int tile_size, int frames) {
  const auto whole_warps = [&](int threads) { return (std::max(threads, frames) + 31) / 32 * 32; };
  constexpr int wide = resident_threads(4);
  if (4 * tile_size <= wide && frames <= wide) {
    if (8 * frames <= wide) return {resident_kernel<0, 4, 8, Drilling, Constant>, wide};
    return {resident_kernel<0, 4, 4, Drilling, Constant>, whole_warps(4 * tile_size)};
  }
  if (influences == 4) return {resident_kernel<4, 1, 2, Drilling, Constant>, whole_warps(tile_size)};
  if (influences == 8) return {resident_kernel<8, 1, 2, Drilling, Constant>, whole_warps(tile_size)};
  return {resident_kernel<0, 1, 2, Drilling, Constant>, whole_warps(tile_size)};
}

}  // namespace fascia::tile
