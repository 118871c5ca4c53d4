#include "core/levels/rounded_rows.hpp"

#include "core/linear/four.hpp"

namespace fascia {

namespace {

template <int N>
void product(const float* block, std::span<const int> columns, const double* x, double* y) {
  Four sum[N] = {};
  for (const int column : columns) {
    const double* from = x + kFrameDofs * column;
    const Four low = load_four(from), high = load_four(from + 4);
    for (int r = 0; r < N; ++r, block += 8) sum[r] += load_four(block) * low + load_four(block + 4) * high;
  }
  for (int r = 0; r < N; ++r) y[r] += (sum[r][0] + sum[r][1]) + (sum[r][2] + sum[r][3]);
}

template <int N>
void transposed_product(const float* block, std::span<const int> columns, const double* y, double* x) {
  for (const int column : columns) {
    double* to = x + kFrameDofs * column;
    Four low = load_four(to), high = load_four(to + 4);
    for (int r = 0; r < N; ++r, block += 8) {
      low += load_four(block) * y[r];
      high += load_four(block + 4) * y[r];
    }
    store_four(low, to);
    store_four(high, to + 4);
  }
}

}  // namespace

RoundedRows::RoundedRows(const BlockRows& blocks) : values_(blocks.values.size() / kFrameDofs * kWide) {
  float* to = values_.data();
  for (std::size_t k = 0; k < blocks.values.size(); k += kFrameDofs, to += kWide)
    for (std::size_t j = 0; j < kFrameDofs; ++j) to[j] = static_cast<float>(blocks.values[k + j]);
}

void RoundedRows::add_product(const BlockRows& blocks, int row, int size, const double* x, double* y) const {
  const std::span<const int> columns = blocks.columns(row);
  if (size == 3) return product<3>(row_of(blocks, row), columns, x, y);
  if (size == 6) return product<6>(row_of(blocks, row), columns, x, y);
  product<12>(row_of(blocks, row), columns, x, y);
}

void RoundedRows::add_transposed_product(const BlockRows& blocks, int row, int size, const double* y, double* x) const {
  const std::span<const int> columns = blocks.columns(row);
  if (size == 3) return transposed_product<3>(row_of(blocks, row), columns, y, x);
  if (size == 6) return transposed_product<6>(row_of(blocks, row), columns, y, x);
  transposed_product<12>(row_of(blocks, row), columns, y, x);
}

}  // namespace fascia
