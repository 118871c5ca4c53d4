#include "core/math/batch.hpp"
#include "core/math/index.hpp"
#include "core/solver/block_matrix.hpp"

#include <algorithm>
#include <cstring>

/// Products with matrices of vertices, of which only the upper triangle is filled.
namespace fascia {

namespace {

using Four = BatchRegister<4>::Type;

inline Four load_four(const double* p) {
  Four r;
  std::memcpy(&r, p, sizeof r);
  return r;
}

inline void copy_three(const double* from, double* to) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

inline Four all(double s) { return Four{} + s; }

/// Rows of a chunk: enough that its overhang is small beside its blocks.
constexpr int kChunkRows = 8192;

/// What blocks of a row do: sum += A x_j, and y_j += Aᵀ x_i. Rows of a block are read four numbers at a time; the
/// fourth, the next row's, meets the fourth of x, zero, or lands in the fourth of y, which nothing reads.
struct RowSums {
  Four sum[2][3] = {};  ///< of even and odd blocks: one addition need not wait for another
  Four x[3];

  explicit RowSums(const double* xi) : x{all(xi[0]), all(xi[1]), all(xi[2])} {}
  template <int Parity>
  void add(const double* b, const double* xj) {
    const Four v = load_four(xj);
    for (int i = 0; i < 3; ++i) sum[Parity][i] += load_four(b + 3 * i) * v;
  }
  void add_transposed(const double* b, double* yj) const {
    const Four y = (load_four(yj) + load_four(b) * x[0]) + (load_four(b + 3) * x[1] + load_four(b + 6) * x[2]);
    std::memcpy(yj, &y, sizeof y);
  }
};

}  // namespace

void BlockMatrix::size_chunks() {
  const int chunks = std::max(1, rows() / kChunkRows);
  overhang_begin_.push_back(0);
  for (int c = 0; c <= chunks; ++c)
    chunk_begin_.push_back(static_cast<int>(static_cast<std::int64_t>(rows()) * c / chunks));
  for (int c = 0; c < chunks; ++c) {
    const int end = chunk_begin_[at(c + 1)];
    int last = end - 1;
    for (int row = chunk_begin_[at(c)]; row < end; ++row) last = std::max(last, columns(row).back());
    overhang_begin_.push_back(overhang_begin_.back() + 4 * at(last + 1 - end));
  }
  wide_x_.resize(4 * at(rows()));
  wide_y_.resize(4 * at(rows()));
  overhang_.resize(overhang_begin_.back());
}

void BlockMatrix::multiply_chunk(int chunk) const {
  const int begin = chunk_begin_[at(chunk)], end = chunk_begin_[at(chunk + 1)];
  std::fill(wide_y_.begin() + 4 * begin, wide_y_.begin() + 4 * end, 0.0);
  std::fill(overhang_.begin() + static_cast<std::ptrdiff_t>(overhang_begin_[at(chunk)]),
            overhang_.begin() + static_cast<std::ptrdiff_t>(overhang_begin_[at(chunk + 1)]), 0.0);
  const double* x = wide_x_.data();
  double* y = wide_y_.data();
  double* beyond = overhang_.data() + overhang_begin_[at(chunk)];
  for (int row = begin; row < end; ++row) {
    const int first = diagonal(row), last = row_begin(row + 1);
    const int* column = column_.data();
    const double* b = block(first);
    RowSums sums(x + 4 * row);
    sums.add<0>(b, x + 4 * row);
    b += 9;
    int k = first + 1;
    for (; k + 1 < last && column[k + 1] < end; k += 2, b += 18) {
      sums.add<1>(b, x + 4 * column[k]);
      sums.add<0>(b + 9, x + 4 * column[k + 1]);
      sums.add_transposed(b, y + 4 * column[k]);
      sums.add_transposed(b + 9, y + 4 * column[k + 1]);
    }
    for (; k < last; ++k, b += 9) {
      sums.add<1>(b, x + 4 * column[k]);
      sums.add_transposed(b, column[k] < end ? y + 4 * column[k] : beyond + 4 * (column[k] - end));
    }
    for (int i = 0; i < 3; ++i) {
      const Four sum = sums.sum[0][i] + sums.sum[1][i];
      y[4 * row + i] += (sum[0] + sum[1]) + sum[2];
    }
  }
}

void BlockMatrix::multiply_upper(ThreadPool& pool, std::span<const double> x, std::span<double> y) const {
  const int chunks = static_cast<int>(chunk_begin_.size()) - 1;
  for (int row = 0; row < rows(); ++row) copy_three(x.data() + 3 * row, wide_x_.data() + 4 * row);
  pool.for_chunks(chunks, [&](int chunk) { multiply_chunk(chunk); });
  pool.for_chunks(chunks, [&](int chunk) {
    const int begin = chunk_begin_[at(chunk)], end = chunk_begin_[at(chunk + 1)];
    for (int row = begin; row < end; ++row) copy_three(wide_y_.data() + 4 * row, y.data() + 3 * row);
    for (int earlier = 0; earlier < chunk; ++earlier) {
      const int start = chunk_begin_[at(earlier + 1)];
      const int stop = start + static_cast<int>((overhang_begin_[at(earlier + 1)] - overhang_begin_[at(earlier)]) / 4);
      const double* values = overhang_.data() + overhang_begin_[at(earlier)];
      for (int row = std::max(begin, start); row < std::min(end, stop); ++row)
        for (int i = 0; i < 3; ++i) y[at(3 * row + i)] += values[4 * (row - start) + i];
    }
  });
}

}  // namespace fascia
