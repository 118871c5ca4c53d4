#include "core/levels/vertex_rows.hpp"

#include "core/levels/galerkin.hpp"
#include "core/linear/four.hpp"

#include <algorithm>
#include <numeric>

namespace fascia {

namespace {

Vec3d vector_at(const double* v) { return {{v[0], v[1], v[2]}}; }

}  // namespace

Corners::Corners(const EdgeEnds& ends, const DofFilter& filter) : parents_(ends.size()), filter_(filter) {
  std::vector<int> coarse(ends.size(), -1);
  origin_.reserve(ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends[i][0] >= 0) continue;
    coarse[i] = count();
    origin_.push_back(static_cast<int>(i));
  }
  begin_.assign(origin_.size() + 1, 0);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const bool own = ends[i][0] < 0;
    parents_[i] = own ? std::array{coarse[i], coarse[i]} : std::array{coarse[at(ends[i][0])], coarse[at(ends[i][1])]};
    ++begin_[at(parents_[i][0]) + 1];
    if (!own) ++begin_[at(parents_[i][1]) + 1];
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  child_.resize(at(begin_.back()));
  std::vector<int> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const auto [a, b] = parents_[i];
    child_[at(next[at(a)]++)] = static_cast<int>(i);
    if (b != a) child_[at(next[at(b)]++)] = static_cast<int>(i);
  }
}

void Corners::restrict_to(const FineRows& fine, ThreadPool& pool, std::span<const double> r,
                          std::span<double> coarse) const {
  pool.for_ranges(count(), 256, [&](int first, int end) {
    for (int c = first; c < end; ++c) {
      Vec3d sum;
      for (const int i : children(c)) sum += turn(i, origin_[at(c)]).apply(vector_at(&r[at(3 * i)])) * weight(i);
      const unsigned fixed = fine.fixed(origin_[at(c)]);
      for (int k = 0; k < 3; ++k) coarse[at(3 * c + k)] = ((fixed >> k) & 1U) != 0 ? 0 : sum[k];
    }
  });
}

void Corners::add_prolonged(const FineRows& fine, ThreadPool& pool, std::span<const double> coarse,
                            std::span<double> x) const {
  pool.for_ranges(fine.rows(), 512, [&](int first, int end) {
    for (int i = first; i < end; ++i) {
      Vec3d u;
      for (const int p : parents(i)) u += turn(origin_[at(p)], i).apply(vector_at(&coarse[at(3 * p)])) * 0.5;
      const unsigned fixed = fine.fixed(i);
      for (int k = 0; k < 3; ++k)
        if (((fixed >> k) & 1U) == 0) x[at(3 * i + k)] += u[k];
    }
  });
}

const double* Corners::turned(int coarse_row, int row, int coarse_column, int column, const double* block,
                              double* copy) const {
  const Turn of_row = turn(row, origin_[at(coarse_row)]), of_column = turn(column, origin_[at(coarse_column)]);
  if (of_row.none() && of_column.none()) return block;
  for (int i = 0; i < 3; ++i) {
    const Vec3d v = of_column.apply(vector_at(block + 3 * i));
    for (int j = 0; j < 3; ++j) copy[3 * i + j] = v[j];
  }
  for (int j = 0; j < 3; ++j) {
    const Vec3d v = of_row.apply({{copy[j], copy[3 + j], copy[6 + j]}});
    for (int i = 0; i < 3; ++i) copy[3 * i + j] = v[i];
  }
  return copy;
}

VertexRows::VertexRows(const FineRows& K, const Corners& corners, ThreadPool& pool) {
  const int rows = corners.count();
  fixed_.reserve(at(rows));
  for (const int node : corners.origin()) fixed_.push_back(K.fixed(node));
  std::vector<std::vector<int>> columns(at(rows));
  std::vector<std::vector<double>> blocks(at(rows));
  pool.for_chunks(galerkin::kChunks, [&](int chunk) {
    galerkin::Slots slots(rows);
    for (int row = galerkin::chunk_begin(rows, chunk); row < galerkin::chunk_begin(rows, chunk + 1); ++row) {
      slots.clear();
      std::vector<double>& sums = blocks[at(row)];
      const auto add = [&](int i, int j, int column, const double* B) {
        if (column < row) return;
        const double weight = corners.weight(i) * corners.weight(j);
        double copy[kSize];
        B = corners.turned(row, i, column, j, B, copy);
        const std::size_t slot = at(slots.add(column) * kSize);
        if (sums.size() <= slot) sums.resize(slot + kSize, 0.0);
        for (int k = 0; k < kDofs; ++k)
          for (int m = 0; m < kDofs; ++m) {
            const bool held = (((fixed(row) >> k) | (fixed(column) >> m)) & 1U) != 0;
            if (!held) sums[slot + at(kDofs * k + m)] += weight * B[kDofs * k + m];
          }
      };
      for (const int i : corners.children(row))
        K.for_each_block(i, [&](int j, const double* B) {
          const auto [a, b] = corners.parents(j);
          add(i, j, a, B);
          if (b != a) add(i, j, b, B);
        });
      columns[at(row)] = slots.met();
    }
  });
  galerkin::mirror<kDofs>(columns, blocks, begin_, column_, values_);
  round(pool);
}

void VertexRows::round(ThreadPool& pool) {
  rounded_.resize(column_.size() * kRoundedSize);
  pool.for_ranges(static_cast<int>(column_.size()), 2048, [&](int first, int end) {
    for (int block = first; block < end; ++block)
      for (int k = 0; k < kDofs; ++k)
        for (int m = 0; m < 4; ++m)
          rounded_[at(kRoundedSize * block + 4 * k + m)] =
              m < kDofs ? static_cast<float>(values_[block_begin(block) + at(kDofs * m + k)]) : 0.0F;
  });
}

void VertexRows::multiply_rounded(ThreadPool& pool, std::span<const double> x, std::span<double> y) const {
  pool.for_ranges(rows(), 128, [&](int first, int end) {
    for (int row = first; row < end; ++row) {
      Four sum = {};
      const float* b = rounded_.data() + at(kRoundedSize * begin_[at(row)]);
      for (int k = begin_[at(row)]; k < begin_[at(row + 1)]; ++k, b += kRoundedSize) {
        const double* v = x.data() + kDofs * column_[at(k)];
        sum += load_four(b) * v[0] + load_four(b + 4) * v[1] + load_four(b + 8) * v[2];
      }
      for (int i = 0; i < kDofs; ++i) y[at(kDofs * row + i)] = sum[i];
    }
  });
}

}  // namespace fascia
