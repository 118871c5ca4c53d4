#include "core/linear/panel_kernels.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace fascia::panel {

namespace {

using Register = Lanes::Register;
constexpr int kPages = 16;  ///< columns that are packed together: each lies on a page of its own

Register load(const double* p) {
  Register r;
  std::memcpy(&r, p, sizeof r);
  return r;
}
void store(const Register& r, double* p) { std::memcpy(p, &r, sizeof r); }

/// C −= A B of M registers by N columns.
template <int M, int N>
void tile(int k, const double* a, std::size_t a_stride, const double* b, double* c, std::size_t stride) {
  Register sum[N][M] = {};
  for (int q = 0; q < k; ++q, a += a_stride, b += N) {
    Register row[M];
#pragma GCC unroll 8
    for (int m = 0; m < M; ++m) row[m] = load(a + m * kLanes);
#pragma GCC unroll 8
    for (int n = 0; n < N; ++n)
#pragma GCC unroll 8
      for (int m = 0; m < M; ++m) sum[n][m] += row[m] * b[n];
  }
#pragma GCC unroll 8
  for (int n = 0; n < N; ++n)
#pragma GCC unroll 8
    for (int m = 0; m < M; ++m) {
      double* to = c + at(n) * stride + m * kLanes;
      store(load(to) - sum[n][m], to);
    }
}

using Tile = void (*)(int, const double*, std::size_t, const double*, double*, std::size_t);

/// The kernel for 1 to 3 registers and 1 to kTileColumns columns is taken from a table.
template <int... Columns>
Tile tile_of(int registers, int columns, std::integer_sequence<int, Columns...>) {
  static constexpr Tile kTiles[3][sizeof...(Columns)] = {
      {tile<1, Columns + 1>...}, {tile<2, Columns + 1>...}, {tile<3, Columns + 1>...}};
  return kTiles[registers - 1][columns - 1];
}
Tile tile_of(int registers, int columns) {
  return tile_of(registers, columns, std::make_integer_sequence<int, kTileColumns>());
}

/// Calls act(first row, registers) for the tiles of some rows, from one on.
template <class Act>
void for_tiles(int begin, int rows, const Act& act) {
  for (int row = begin; row < rows; row += kTileRows) act(row, std::min(kTileRows, padded(rows - row)) / kLanes);
}

/// A few columns next to one another, of which the diagonal block is known, and what rows are divided by.
struct Triangle {
  int columns;
  double below[kTileColumns][kTileColumns];  ///< [i][j]: number of row i and column j, times the sign of j; i > j
  double inverse[kTileColumns];

  Triangle(const double* diagonal, std::size_t stride, int n, const double* sign) : columns(n) {
    for (int j = 0; j < n; ++j) {
      const double s = sign == nullptr ? 1.0 : sign[j];
      for (int i = j + 1; i < n; ++i) below[i][j] = diagonal[at(j) * stride + at(i)] * s;
      inverse[j] = s / diagonal[at(j) * stride + at(j)];
    }
  }
  /// Rows [begin, end), by whole registers, so that all round alike: up to padded(end), and none before begin.
  void divide_rows(double* t, std::size_t stride, int begin, int end) const {
    for (int row = begin / kLanes * kLanes; row < end; row += kLanes) {
      const int kept = std::max(0, begin - row);
      Register x[kTileColumns];
      for (int j = 0; j < columns; ++j) {
        double* to = t + at(j) * stride + row;
        Register rest = load(to);
        for (int i = 0; i < j; ++i) rest -= x[i] * below[j][i];
        x[j] = rest * inverse[j];
        for (int lane = kept; kept > 0 && lane < kLanes; ++lane) to[lane] = x[j][lane];
        if (kept == 0) store(x[j], to);
      }
    }
  }
};

}  // namespace

void pack_left(const double* a, std::size_t stride, int m, int k, double* packed) {
  for (int first = 0; first < k; first += kPages)
    for_tiles(0, m, [&](int row, int registers) {
      const int room = registers * kLanes, rows = std::min(room, m - row);
      double* to = packed + at(row) * at(k) + at(first) * at(room);
      for (int q = first; q < std::min(k, first + kPages); ++q, to += room) {
        const double* from = a + at(q) * stride + row;
        if (rows == kTileRows) {
          std::memcpy(to, from, sizeof(double) * kTileRows);
          continue;
        }
        std::copy_n(from, rows, to);
        std::fill(to + rows, to + room, 0.0);
      }
    });
}

void pack_right(const double* b_transposed, std::size_t stride, int n, int k, const double* sign, double* packed) {
  for (int begin = 0; begin < k; begin += kPages)
    for (int first = 0; first < n; first += kTileColumns) {
      const int columns = std::min(kTileColumns, n - first);
      double* to = packed + at(first) * at(k) + at(begin) * at(columns);
      for (int q = begin; q < std::min(k, begin + kPages); ++q, to += columns) {
        const double* from = b_transposed + at(q) * stride + first;
        if (columns == kTileColumns)
          std::memcpy(to, from, sizeof(double) * kTileColumns);
        else
          std::copy_n(from, columns, to);
        if (sign != nullptr && sign[q] < 0)
          for (int j = 0; j < columns; ++j) to[j] = -to[j];
      }
    }
}

void subtract_product(int m, int n, int k, const Left& a, const double* packed_right, double* c, std::size_t stride,
                      bool lower) {
  for (int first = 0; first < n; first += kTileColumns) {
    const int columns = std::min(kTileColumns, n - first);
    const double* b = packed_right + at(first) * at(k);
    for_tiles(lower ? first / kTileRows * kTileRows : 0, m, [&](int row, int registers) {
      const double* from = a.first + at(row) * (a.stride == 0 ? at(k) : 1);
      tile_of(registers, columns)(k, from, a.stride == 0 ? at(registers * kLanes) : a.stride, b,
                                  c + at(first) * stride + row, stride);
    });
  }
}

bool factorize_diagonal(double* t, std::size_t stride, int rows, int columns, double* sign, const double* least,
                        double* scratch) {
  for (int first = 0; first < columns; first += kTileColumns) {
    const int n = std::min(kTileColumns, columns - first);
    double* corner = t + at(first) * stride + first;
    pack_right(t + first, stride, n, first, sign, scratch);
    const int skipped = first / kLanes * kLanes;
    subtract_product(rows - skipped, n, first, {t + skipped, stride}, scratch, t + at(first) * stride + skipped, stride,
                     false);
    for (int j = 0; j < n; ++j) {
      double* column = corner + at(j) * stride;
      for (int q = 0; q < j; ++q) {
        const double* before = corner + at(q) * stride;
        const double factor = before[j] * (sign == nullptr ? 1.0 : sign[first + q]);
        for (int i = j; i < n; ++i) column[i] -= before[i] * factor;
      }
      const double pivot = column[j];
      if (!((sign == nullptr ? pivot : std::abs(pivot)) > least[first + j]) || !std::isfinite(pivot)) return false;
      if (sign != nullptr) sign[first + j] = pivot < 0 ? -1 : 1;
      column[j] = std::sqrt(std::abs(pivot));
      const double inverse = (pivot < 0 ? -1 : 1) / column[j];
      for (int i = j + 1; i < n; ++i) column[i] *= inverse;
    }
    const Triangle triangle(corner, stride, n, sign == nullptr ? nullptr : sign + first);
    triangle.divide_rows(t + at(first) * stride, stride, first + n, rows);
  }
  return true;
}

void solve_rows(double* t, std::size_t stride, int rows, int columns, const double* d, std::size_t d_stride,
                const double* sign, double* scratch) {
  for (int first = 0; first < columns; first += kTileColumns) {
    const int n = std::min(kTileColumns, columns - first);
    pack_right(d + first, d_stride, n, first, sign, scratch);
    subtract_product(rows, n, first, {t, stride}, scratch, t + at(first) * stride, stride, false);
    const Triangle triangle(d + at(first) * d_stride + first, d_stride, n, sign == nullptr ? nullptr : sign + first);
    triangle.divide_rows(t + at(first) * stride, stride, 0, rows);
  }
}

}  // namespace fascia::panel
