#pragma once

#include "gpu/tile_resident.cuh"

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
template <bool Drilling, class Constant>
ResidentChoice<Constant> choose_resident(int influences, int tile_size) {
  constexpr int most_wide = kResidentThreads / 4;
  if (tile_size <= most_wide) return {resident_kernel<0, 4, 4, Drilling, Constant>, (4 * tile_size + 31) / 32 * 32};
  const int threads = (tile_size + 31) / 32 * 32;
  if (influences == 4) return {resident_kernel<4, 1, 2, Drilling, Constant>, threads};
  if (influences == 8) return {resident_kernel<8, 1, 2, Drilling, Constant>, threads};
  return {resident_kernel<0, 1, 2, Drilling, Constant>, threads};
}

}  // namespace fascia::tile
