#include "core/linear/supernodes.hpp"

#include "core/base/index.hpp"
#include "core/linear/four.hpp"

#include <algorithm>
#include <array>

namespace fascia {

namespace {

constexpr int kColumns = 4;  ///< that are read together

/// Some columns of a supernode that follow one another.
template <int N, class T>
struct Columns {
  const T* first;  ///< their diagonal entry of the first
  int rows;        ///< from there on
  std::size_t stride;

  double at(int i, int j) const { return column(j)[i]; }
  const T* column(int j) const { return first + fascia::at(j) * stride; }

  /// w −= L x, where x are the first rows of w once they are divided by L.
  void forward(double* w) const {
    std::array<double, N> x;
    for (int j = 0; j < N; ++j) {
      x[fascia::at(j)] = w[j];
      for (int k = 0; k < j; ++k) x[fascia::at(j)] -= at(j, k) * x[fascia::at(k)];
      w[j] = x[fascia::at(j)] /= at(j, j);
    }
    int i = N;
    for (; i + 4 <= rows; i += 4) {
      Four sum = load_four(w + i);
      for (int j = 0; j < N; ++j) sum -= load_four(column(j) + i) * x[fascia::at(j)];
      store_four(sum, w + i);
    }
    for (; i < rows; ++i)
      for (int j = 0; j < N; ++j) w[i] -= at(i, j) * x[fascia::at(j)];
  }

  /// The first rows of w become Lᵀ \ w, where those below are known.
  void backward(double* w) const {
    Four sums[N] = {};
    std::array<double, N> rest{};
    int i = N;
    for (; i + 4 <= rows; i += 4) {
      const Four below = load_four(w + i);
      for (int j = 0; j < N; ++j) sums[j] += load_four(column(j) + i) * below;
    }
    for (; i < rows; ++i)
      for (int j = 0; j < N; ++j) rest[fascia::at(j)] += at(i, j) * w[i];
    for (int j = N - 1; j >= 0; --j) {
      const Four& sum = sums[j];
      double x = w[j] - ((sum[0] + sum[1]) + (sum[2] + sum[3]) + rest[fascia::at(j)]);
      for (int k = j + 1; k < N; ++k) x -= at(k, j) * w[k];
      w[j] = x / at(j, j);
    }
  }
};

/// One supernode, and room for the numbers of its rows.
template <class T>
struct Supernode {
  int columns, rows, first;
  const int* below;  ///< rows from the end of its columns on
  const T* value;

  Supernode(const Supernodes<T>& all, int s)
      : columns(all.first_column[at(s + 1)] - all.first_column[at(s)]),
        rows(all.row_begin[at(s + 1)] - all.row_begin[at(s)]),
        first(all.first_column[at(s)]),
        below(all.row.data() + all.row_begin[at(s)] + columns),
        value(all.value.data() + all.value_begin[at(s)]) {}

  template <int N>
  Columns<N, T> from(int j) const {
    return {value + at(j) * at(rows) + at(j), rows - j, at(rows)};
  }

  void forward(double* x, double* w) const {
    std::copy_n(x + first, columns, w);
    std::fill(w + columns, w + rows, 0.0);
    int j = 0;
    for (; j + kColumns <= columns; j += kColumns) from<kColumns>(j).forward(w + j);
    for (; j < columns; ++j) from<1>(j).forward(w + j);
    std::copy_n(w, columns, x + first);
    for (int i = columns; i < rows; ++i) x[below[i - columns]] += w[i];
  }

  void backward(double* x, double* w) const {
    std::copy_n(x + first, columns, w);
    for (int i = columns; i < rows; ++i) w[i] = x[below[i - columns]];
    int j = columns;
    for (; j % kColumns != 0; --j) from<1>(j - 1).backward(w + j - 1);
    for (; j > 0; j -= kColumns) from<kColumns>(j - kColumns).backward(w + j - kColumns);
    std::copy_n(w, columns, x + first);
  }
};

}  // namespace

template <class T>
void solve(const Supernodes<T>& L, std::span<double> x, std::span<double> work) {
  for (int s = 0; s < L.count(); ++s) Supernode(L, s).forward(x.data(), work.data());
  for (int s = L.count(); s-- > 0;) Supernode(L, s).backward(x.data(), work.data());
}

template void solve(const Supernodes<double>&, std::span<double>, std::span<double>);
template void solve(const Supernodes<float>&, std::span<double>, std::span<double>);

}  // namespace fascia
