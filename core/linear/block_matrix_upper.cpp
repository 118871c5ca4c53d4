#include "core/base/index.hpp"
#include "core/linear/block_matrix.hpp"
#include "core/math/batch.hpp"

#include <algorithm>
#include <cstring>

/// Products with matrices of vertices only or of rigid frames only, of which the upper triangle is filled.
namespace fascia {

namespace {

/// Numbers of a node in the vectors here: a register's, of which the last ones stay zero or are not read.
template <int N>
constexpr int kWide = N == 3 ? 4 : 8;

template <int N>
using Wide = typename BatchRegister<kWide<N>>::Type;

template <int N>
inline Wide<N> load(const double* p) {
  Wide<N> r;
  std::memcpy(&r, p, sizeof r);
  return r;
}

template <int N>
inline void copy_node(const double* from, double* to) {
  for (int i = 0; i < N; ++i) to[i] = from[i];
}

/// Rows of a chunk: enough that its overhang is small beside its blocks.
template <int N>
constexpr int kChunkRows = N == 3 ? 8192 : 2048;

/// What blocks of a row do: sum += A x_j, and y_j += Aᵀ x_i. Rows of a block are read a register at a time; what
/// exceeds the row, the beginning of the next, meets zeros of x, or lands in numbers of y that nothing reads.
template <int N>
struct UpperRowSums {
  static constexpr int kParities = N == 3 ? 2 : 1;  ///< of even and odd blocks: one addition need not wait for another
  Wide<N> sum[kParities][N] = {};
  Wide<N> x[N];

  explicit UpperRowSums(const double* xi) {
    for (int i = 0; i < N; ++i) x[i] = Wide<N>{} + xi[i];
  }
  template <int Parity>
  void add(const double* b, const double* xj) {
    const Wide<N> v = load<N>(xj);
    for (int i = 0; i < N; ++i) sum[Parity % kParities][i] += load<N>(b + N * i) * v;
  }
  void add_transposed(const double* b, double* yj) const {
    Wide<N> y = load<N>(yj) + load<N>(b) * x[0];
    for (int i = 1; i + 1 < N; i += 2) y += load<N>(b + N * i) * x[i] + load<N>(b + N * (i + 1)) * x[i + 1];
    if constexpr (N % 2 == 0) y += load<N>(b + N * (N - 1)) * x[N - 1];
    std::memcpy(yj, &y, sizeof y);
  }
  double total(int i) const {
    Wide<N> all = sum[0][i];
    if constexpr (kParities == 2) all += sum[1][i];
    double s = all[0];
    for (int k = 1; k < N; ++k) s += all[k];
    return s;
  }
};

}  // namespace

void BlockMatrix::size_chunks() {
  const int wide = uniform_ == 3 ? kWide<3> : kWide<6>;
  const int chunks = std::max(1, rows() / (uniform_ == 3 ? kChunkRows<3> : kChunkRows<6>));
  overhang_begin_.push_back(0);
  for (int c = 0; c <= chunks; ++c)
    chunk_begin_.push_back(static_cast<int>(static_cast<std::int64_t>(rows()) * c / chunks));
  if (chunks > 1) overhang_slot_.resize(column_.size());
  for (int c = 0; c < chunks; ++c) {
    const int begin = row_begin(chunk_begin_[at(c)]), end = chunk_begin_[at(c + 1)], last = row_begin(end);
    std::vector<int> far;
    for (int k = begin; k < last; ++k)
      if (column_[at(k)] >= end) far.push_back(column_[at(k)]);
    std::sort(far.begin(), far.end());
    far.erase(std::unique(far.begin(), far.end()), far.end());
    for (int k = begin; k < last; ++k)
      if (column_[at(k)] >= end)
        overhang_slot_[at(k)] =
            static_cast<int>(std::lower_bound(far.begin(), far.end(), column_[at(k)]) - far.begin());
    overhang_row_.insert(overhang_row_.end(), far.begin(), far.end());
    overhang_begin_.push_back(overhang_row_.size());
  }
  wide_x_.resize(at(wide) * at(rows()));
  wide_y_.resize(at(wide) * at(rows()));
  overhang_.resize(at(wide) * overhang_row_.size());
}

template <int N>
void BlockMatrix::multiply_chunk(int chunk) const {
  constexpr int W = kWide<N>, B = N * N;
  const int begin = chunk_begin_[at(chunk)], end = chunk_begin_[at(chunk + 1)];
  std::fill(wide_y_.begin() + W * begin, wide_y_.begin() + W * end, 0.0);
  std::fill(overhang_.begin() + static_cast<std::ptrdiff_t>(W * overhang_begin_[at(chunk)]),
            overhang_.begin() + static_cast<std::ptrdiff_t>(W * overhang_begin_[at(chunk + 1)]), 0.0);
  const double* x = wide_x_.data();
  double* y = wide_y_.data();
  double* beyond = overhang_.data() + W * overhang_begin_[at(chunk)];
  for (int row = begin; row < end; ++row) {
    const int first = diagonal(row), last = row_begin(row + 1);
    const int* column = column_.data();
    const double* b = block(first);
    UpperRowSums<N> sums(x + W * row);
    sums.template add<0>(b, x + W * row);
    b += B;
    int k = first + 1;
    for (; k + 1 < last && column[k + 1] < end; k += 2, b += 2 * B) {
      sums.template add<1>(b, x + W * column[k]);
      sums.template add<0>(b + B, x + W * column[k + 1]);
      sums.add_transposed(b, y + W * column[k]);
      sums.add_transposed(b + B, y + W * column[k + 1]);
    }
    for (; k < last; ++k, b += B) {
      sums.template add<1>(b, x + W * column[k]);
      sums.add_transposed(b, column[k] < end ? y + W * column[k] : beyond + W * overhang_slot_[at(k)]);
    }
    for (int i = 0; i < N; ++i) y[W * row + i] += sums.total(i);
  }
}

template <int N>
void BlockMatrix::multiply_upper(ThreadPool& pool, std::span<const double> x, std::span<double> y) const {
  constexpr int W = kWide<N>;
  const int chunks = static_cast<int>(chunk_begin_.size()) - 1;
  for (int row = 0; row < rows(); ++row) copy_node<N>(x.data() + N * row, wide_x_.data() + W * row);
  pool.for_chunks(chunks, [&](int chunk) { multiply_chunk<N>(chunk); });
  pool.for_chunks(chunks, [&](int chunk) {
    const int begin = chunk_begin_[at(chunk)], end = chunk_begin_[at(chunk + 1)];
    for (int row = begin; row < end; ++row) copy_node<N>(wide_y_.data() + W * row, y.data() + N * row);
    for (int earlier = 0; earlier < chunk; ++earlier) {
      const auto stop = overhang_row_.begin() + static_cast<std::ptrdiff_t>(overhang_begin_[at(earlier + 1)]);
      auto row = overhang_row_.begin() + static_cast<std::ptrdiff_t>(overhang_begin_[at(earlier)]);
      row = std::lower_bound(row, stop, begin);
      const double* values = overhang_.data() + W * (row - overhang_row_.begin());
      for (; row != stop && *row < end; ++row, values += W)
        for (int i = 0; i < N; ++i) y[at(N * *row + i)] += values[i];
    }
  });
}

template void BlockMatrix::multiply_upper<3>(ThreadPool&, std::span<const double>, std::span<double>) const;
template void BlockMatrix::multiply_upper<6>(ThreadPool&, std::span<const double>, std::span<double>) const;

}  // namespace fascia
