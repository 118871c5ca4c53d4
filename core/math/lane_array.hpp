#pragma once

#include "core/math/batch.hpp"
#include "core/math/mat3.hpp"

namespace fascia {

/// N batches that are not cleared at first.
template <int N>
struct LaneArray {
  alignas(sizeof(Lanes)) double numbers[N * kBatchWidth];

  Lanes operator[](int k) const { return Lanes::load(numbers + k * kBatchWidth); }
  void set(int k, const Lanes& value) { value.store(numbers + k * kBatchWidth); }
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
