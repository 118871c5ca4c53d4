#pragma once

#include "core/math/batch.hpp"
#include "core/math/mat3.hpp"

namespace fascia {

/// N batches that are not cleared at first.
template <int N, int W = kBatchWidth>
struct LaneArray {
  alignas(sizeof(Batch<W>)) double numbers[N * W];

  Batch<W> operator[](int k) const { return Batch<W>::load(numbers + k * W); }
  void set(int k, const Batch<W>& value) { value.store(numbers + k * W); }
};

/// Likewise a matrix of batches.
struct LaneMatrix : LaneArray<9> {
  Lanes operator()(int i, int j) const { return (*this)[3 * i + j]; }
  void set(const Mat3<Lanes>& m) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) LaneArray::set(3 * i + j, m(i, j));
  }
  operator Mat3<Lanes>() const {  // NOLINT: it is one
    Mat3<Lanes> m;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m(i, j) = (*this)(i, j);
    return m;
  }
};

}  // namespace fascia
