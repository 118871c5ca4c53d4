#include "core/base/index.hpp"
#include "core/linear/block_matrix.hpp"
#include "core/linear/four.hpp"

#include <algorithm>
#include <numeric>

/// Products with matrices of vertices only or of rigid frames only, of which the upper triangle is filled.
namespace fascia {

namespace {

inline void add(const Four& value, double* to) { store_four(load_four(to) + value, to); }

/// Numbers of a node in the vectors here, whole registers: x₀ x₁ x₂ 0, or x₀ … x₅ x₀ x₁. In a sum the last ones mean
/// nothing.
template <int N>
constexpr int kWide = N == 3 ? 4 : 8;

template <int N>
inline void widen(const double* from, double* to) {
  for (int i = 0; i < N; ++i) to[i] = from[i];
  if constexpr (N == 6) {
    to[6] = from[0];
    to[7] = from[1];
  }
}

/// What blocks of a row do: sum += A x_j, and y_j += Aᵀ x_i. The diagonal one has the first alone.
template <int N>
struct UpperRow;

/// Rows of a block are read a register at a time; what exceeds the row, the beginning of the next, meets the zero of x,
/// or lands in the number of y that means nothing.
template <>
struct UpperRow<3> {
  Four sum[2][3] = {};  ///< of even and odd blocks: one addition need not wait for another
  Four x[3];

  explicit UpperRow(const double* xi) {
    for (int i = 0; i < 3; ++i) x[i] = Four{} + xi[i];
  }
  template <int Parity, class T>
  void take_diagonal(const T* b, const double* xj) {
    const Four v = load_four(xj);
    for (int i = 0; i < 3; ++i) sum[Parity][i] += load_four(b + 3 * i) * v;
  }
  template <int Parity, class T>
  void take(const T* b, const double* xj, double* yj) {
    take_diagonal<Parity>(b, xj);
    add(load_four(b) * x[0] + load_four(b + 3) * x[1] + load_four(b + 6) * x[2], yj);
  }
  void add_to(double* y) const {
    for (int i = 0; i < 3; ++i) {
      const Four all = sum[0][i] + sum[1][i];
      y[i] += all[0] + all[1] + all[2];
    }
  }
};

/// The 36 entries are nine registers, each of which is read once. By columns they meet x₀ … x₃, x₄ x₅ x₀ x₁ and
/// x₂ … x₅ of x_j in turn, by rows nine registers of x_i.
template <>
struct UpperRow<6> {
  Four sum[9] = {};
  Four x[9];

  explicit UpperRow(const double* xi) {
    for (int c = 0; c < 9; ++c)
      for (int k = 0; k < 4; ++k) x[c][k] = xi[(4 * c + k) / 6];
  }
  template <int, class T>
  void take_diagonal(const T* b, const double* xj) {
    const Four v[3] = {load_four(xj), load_four(xj + 4), load_four(xj + 2)};
    for (int c = 0; c < 9; ++c) sum[c] += load_four(b + 4 * c) * v[c % 3];
  }
  template <int, class T>
  void take(const T* b, const double* xj, double* yj) {
    const Four v[3] = {load_four(xj), load_four(xj + 4), load_four(xj + 2)};
    Four t[3] = {};  // of columns 0 … 3, 4 5 0 1 and 2 … 5
    for (int c = 0; c < 9; ++c) {
      const Four entries = load_four(b + 4 * c);
      sum[c] += entries * v[c % 3];
      t[c % 3] += entries * x[c];
    }
    add(t[0] + __builtin_shufflevector(t[1], t[2], 2, 3, 4, 5), yj);
    const Four last = __builtin_shufflevector(t[1], t[2], 0, 1, 6, 7);
    add(last + __builtin_shufflevector(last, last, 2, 3, 2, 3), yj + 4);
  }
  void add_to(double* y) const {
    for (int r = 0; r < 6; r += 2) {  // of three registers, two rows
      const Four *a = sum + 3 * (r / 2), *b = a + 1, *c = a + 2;
      y[r] += ((*a)[0] + (*a)[1]) + ((*a)[2] + (*a)[3]) + ((*b)[0] + (*b)[1]);
      y[r + 1] += ((*b)[2] + (*b)[3]) + ((*c)[0] + (*c)[1]) + ((*c)[2] + (*c)[3]);
    }
  }
};

}  // namespace

namespace {

/// Has the processor fetch what a product reads some lines later: of a matrix that no cache holds it fetches too few by
/// itself.
template <class T, int Count>
inline void fetch_ahead(const T* b) {
  constexpr std::size_t kAhead = 2048, kLine = 64;
  const auto* line = reinterpret_cast<const char*>(b) + kAhead;
  for (std::size_t k = 0; k < Count * sizeof(T); k += kLine) __builtin_prefetch(line + k);
}

/// Values of a chunk [bytes]: enough that a thread is worth waking for it, and that its overhang is small beside it.
constexpr std::size_t kChunkBytes = 1 << 19;
constexpr int kMostChunks = 128;

}  // namespace

/// Chunks have equally many values, but for whole rows.
void BlockMatrix::size_chunks() {
  const int wide = uniform_ == 3 ? kWide<3> : kWide<6>;
  const auto chunks =
      static_cast<int>(std::clamp<std::size_t>(value_count() * sizeof(double) / kChunkBytes, 1, kMostChunks));
  overhang_begin_.push_back(0);
  chunk_begin_.push_back(0);
  for (int c = 1; c <= chunks; ++c) {
    const std::size_t end = value_count() / at(chunks) * at(c);
    int row = chunk_begin_.back();
    while (row < rows() && (c == chunks || value_begin_[at(row_begin(row))] < end)) ++row;
    chunk_begin_.push_back(row);
  }
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
  part_begin_.push_back(0);
  for (int c = 0; c < chunks; ++c) {
    for (int earlier = 0; earlier < c; ++earlier) {
      const auto begin = overhang_row_.begin() + static_cast<std::ptrdiff_t>(overhang_begin_[at(earlier)]),
                 end = overhang_row_.begin() + static_cast<std::ptrdiff_t>(overhang_begin_[at(earlier + 1)]);
      const auto first = std::lower_bound(begin, end, chunk_begin_[at(c)]),
                 last = std::lower_bound(first, end, chunk_begin_[at(c + 1)]);
      if (first != last)
        part_.push_back(
            {static_cast<int>(first - overhang_row_.begin()), static_cast<int>(last - overhang_row_.begin())});
    }
    part_begin_.push_back(static_cast<int>(part_.size()));
  }
  wide_x_.resize(at(wide) * at(rows()));
  wide_y_.resize(at(wide) * at(rows()));
  overhang_.resize(at(wide) * overhang_row_.size());
}

template <int N, class T>
void BlockMatrix::multiply_chunk(const T* values, int chunk) const {
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
    const T* b = values + value_begin_[at(first)];
    UpperRow<N> of(x + W * row);
    of.template take_diagonal<0>(b, x + W * row);
    b += B;
    int k = first + 1;
    for (; k + 1 < last && column[k + 1] < end; k += 2, b += 2 * B) {
      fetch_ahead<T, 2 * B>(b);
      of.template take<1>(b, x + W * column[k], y + W * column[k]);
      of.template take<0>(b + B, x + W * column[k + 1], y + W * column[k + 1]);
    }
    for (; k < last; ++k, b += B) {
      fetch_ahead<T, B>(b);
      of.template take<1>(b, x + W * column[k],
                          column[k] < end ? y + W * column[k] : beyond + W * overhang_slot_[at(k)]);
    }
    of.add_to(y + W * row);
  }
}

/// The sums of a chunk's rows, with what those before it have for them. @return  x · y of these
template <int N>
double BlockMatrix::gather_chunk(int chunk, std::span<const double> x, std::span<double> y) const {
  constexpr int W = kWide<N>;
  for (int p = part_begin_[at(chunk)]; p < part_begin_[at(chunk + 1)]; ++p)
    for (int k = part_[at(p)].begin; k < part_[at(p)].end; ++k) {
      const double* sums = overhang_.data() + W * k;
      double* to = wide_y_.data() + W * overhang_row_[at(k)];
      for (int i = 0; i < W; i += 4) add(load_four(sums + i), to + i);
    }
  double products[N] = {};
  for (int row = chunk_begin_[at(chunk)]; row < chunk_begin_[at(chunk + 1)]; ++row)
    for (int i = 0; i < N; ++i) {
      const double sum = wide_y_[at(W * row + i)];
      y[at(N * row + i)] = sum;
      products[i] += x[at(N * row + i)] * sum;
    }
  return std::accumulate(products, products + N, 0.0);
}

template <int N, class T>
double BlockMatrix::multiply_upper(const T* values, ThreadPool& pool, const Xpay& renew, std::span<const double> x,
                                   std::span<double> y) const {
  constexpr int W = kWide<N>;
  const int chunks = static_cast<int>(chunk_begin_.size()) - 1;
  pool.for_chunks(chunks, [&](int chunk) {
    renew(at(N * chunk_begin_[at(chunk)]), at(N * chunk_begin_[at(chunk + 1)]));
    for (int row = chunk_begin_[at(chunk)]; row < chunk_begin_[at(chunk + 1)]; ++row)
      widen<N>(x.data() + N * row, wide_x_.data() + W * row);
  });
  pool.for_chunks(chunks, [&](int chunk) { multiply_chunk<N>(values, chunk); });
  pool.for_chunks(chunks, [&](int chunk) { sums_[at(chunk)] = gather_chunk<N>(chunk, x, y); });
  return std::accumulate(sums_.begin(), sums_.end(), 0.0);
}

template double BlockMatrix::multiply_upper<3>(const double*, ThreadPool&, const Xpay&, std::span<const double>,
                                               std::span<double>) const;
template double BlockMatrix::multiply_upper<6>(const double*, ThreadPool&, const Xpay&, std::span<const double>,
                                               std::span<double>) const;
template double BlockMatrix::multiply_upper<3>(const float*, ThreadPool&, const Xpay&, std::span<const double>,
                                               std::span<double>) const;
template double BlockMatrix::multiply_upper<6>(const float*, ThreadPool&, const Xpay&, std::span<const double>,
                                               std::span<double>) const;

}  // namespace fascia
