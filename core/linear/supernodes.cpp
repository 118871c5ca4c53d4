#include "core/linear/supernodes.hpp"

#include "core/base/index.hpp"
#include "core/linear/four.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace fascia {

namespace {

constexpr int kColumns = 4;  ///< that are read together

/// An index of either width that is known not to be negative.
template <class Int>
constexpr std::size_t at(Int i) {
  return static_cast<std::size_t>(i);
}

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
  int columns, rows;
  int first;
  const int* below;  ///< rows from the end of its columns on
  const T* value;
  const double* sign;

  Supernode(const Supernodes<T>& all, int s)
      : columns(all.first_column[at(s + 1)] - all.first_column[at(s)]),
        rows(static_cast<int>(all.row_begin[at(s + 1)] - all.row_begin[at(s)])),
        first(all.first_column[at(s)]),
        below(all.row.data() + all.row_begin[at(s)] + columns),
        value(all.value.data() + all.value_begin[at(s)]),
        sign(all.sign.empty() ? nullptr : all.sign.data() + first) {}

  template <int N>
  Columns<N, T> from(int j) const {
    return {value + at(j) * at(rows) + at(j), rows - j, at(rows)};
  }

  /// @param add  add(row, number) takes what the rows below get
  template <class Add>
  void forward(double* x, double* w, const Add& add) const {
    std::copy_n(x + first, columns, w);
    std::fill(w + columns, w + rows, 0.0);
    int j = 0;
    for (; j + kColumns <= columns; j += kColumns) from<kColumns>(j).forward(w + j);
    for (; j < columns; ++j) from<1>(j).forward(w + j);
    std::copy_n(w, columns, x + first);
    for (int i = columns; i < rows; ++i) add(below[i - columns], w[i]);
  }

  /// Takes S too: it lies between both triangles.
  void backward(double* x, double* w) const {
    std::copy_n(x + first, columns, w);
    for (int j = 0; sign != nullptr && j < columns; ++j) w[j] *= sign[j];
    for (int i = columns; i < rows; ++i) w[i] = x[below[i - columns]];
    int j = columns;
    for (; j % kColumns != 0; --j) from<1>(j - 1).backward(w + j - 1);
    for (; j > 0; j -= kColumns) from<kColumns>(j - kColumns).backward(w + j - kColumns);
    std::copy_n(w, columns, x + first);
  }
};

}  // namespace

/// The largest subtrees are taken apart until each is a small part of the whole. Columns are in postorder, so that a
/// subtree is a run of supernodes; where one is not, it stays on top.
void SupernodeSolver::find_subtrees(std::span<const int> first_column, std::span<const std::int64_t> row_begin,
                                    std::span<const std::int64_t> value_begin, std::span<const int> row) {
  constexpr int kParts = 12;
  constexpr double kWorthThreads = 1e5;  ///< numbers of L: some 50 µs
  const std::size_t count = first_column.size() - 1;
  std::vector<int> supernode_of(at(first_column.back())), first(count), size(count, 1);
  for (std::size_t s = 0; s < count; ++s) {
    most_rows_ = std::max(most_rows_, at(row_begin[s + 1] - row_begin[s]));
    std::fill(supernode_of.begin() + first_column[s], supernode_of.begin() + first_column[s + 1], static_cast<int>(s));
    first[s] = static_cast<int>(s);
  }
  std::vector<std::vector<int>> children(count);
  std::vector<int> roots;
  for (std::size_t s = 0; s < count; ++s) {  // children come before their parents
    const std::int64_t begin = row_begin[s] + (first_column[s + 1] - first_column[s]);
    if (begin == row_begin[s + 1]) {
      roots.push_back(static_cast<int>(s));
      continue;
    }
    const std::size_t parent = at(supernode_of[at(row[at(begin)])]);
    children[parent].push_back(static_cast<int>(s));
    first[parent] = std::min(first[parent], first[s]);
    size[parent] += size[s];
  }
  const auto numbers = [&](int s) {
    return static_cast<double>(value_begin[at(s + 1)] - value_begin[at(first[at(s)])]);
  };
  const auto smaller = [&](int a, int b) { return numbers(a) < numbers(b); };
  const double all = count == 0 ? 0.0 : static_cast<double>(value_begin[count]);
  if (all >= kWorthThreads) {
    std::make_heap(roots.begin(), roots.end(), smaller);
    while (!roots.empty()) {
      std::pop_heap(roots.begin(), roots.end(), smaller);
      const int root = roots.back();
      roots.pop_back();
      const bool run = size[at(root)] == root + 1 - first[at(root)];
      if (run && (numbers(root) * kParts <= all || children[at(root)].empty())) {
        subtree_.push_back({first[at(root)], root + 1, first_column[at(root) + 1]});
        continue;
      }
      for (const int child : children[at(root)]) {
        roots.push_back(child);
        std::push_heap(roots.begin(), roots.end(), smaller);
      }
    }
  }
  keep_large(value_begin, all / kParts);
  std::vector<char> on_top(count, 1);
  for (const Subtree& part : subtree_) std::fill(on_top.begin() + part.begin, on_top.begin() + part.end, char{0});
  place_.assign(supernode_of.size(), -1);
  for (std::size_t s = 0; s < count; ++s) {
    if (on_top[s] == 0) continue;
    top_.push_back(static_cast<int>(s));
    for (int column = first_column[s]; column < first_column[s + 1]; ++column) {
      place_[at(column)] = static_cast<int>(top_column_.size());
      top_column_.push_back(column);
    }
  }
  work_.resize((subtree_.size() + 1) * most_rows_);
  sums_.resize(subtree_.size() * top_column_.size());
}

/// Neighbours become one up to so many numbers. Those that stay small go on top, for each has sums for all of it; so do
/// all where they are but a small part of the whole.
void SupernodeSolver::keep_large(std::span<const std::int64_t> value_begin, double most) {
  constexpr double kSmall = 0.4, kFew = 4;  // of what a subtree may have at most
  const auto numbers = [&](const Subtree& part) {
    return static_cast<double>(value_begin[at(part.end)] - value_begin[at(part.begin)]);
  };
  std::sort(subtree_.begin(), subtree_.end(), [](const Subtree& a, const Subtree& b) { return a.begin < b.begin; });
  std::vector<Subtree> joined;
  for (const Subtree& next : subtree_) {
    const bool follows = !joined.empty() && joined.back().end == next.begin;
    if (follows && numbers(joined.back()) + numbers(next) <= most)
      joined.back() = {joined.back().begin, next.end, next.end_column};
    else
      joined.push_back(next);
  }
  std::erase_if(joined, [&](const Subtree& part) { return numbers(part) < kSmall * most; });
  double all = 0;
  for (const Subtree& part : joined) all += numbers(part);
  if (all < kFew * most) joined.clear();
  subtree_ = std::move(joined);
}

template <class T>
void SupernodeSolver::solve(const Supernodes<T>& L, ThreadPool* pool, std::span<double> x) {
  const std::size_t top = top_column_.size();
  const auto for_subtrees = [&](const auto& act) {
    const auto of = [&](int k) { act(subtree_[at(k)], work_.data() + at(k) * most_rows_, sums_.data() + at(k) * top); };
    if (pool != nullptr)
      pool->for_chunks(subtrees(), of);
    else
      for (int k = 0; k < subtrees(); ++k) of(k);
  };
  for_subtrees([&](const Subtree& part, double* work, double* sums) {
    std::fill_n(sums, top, 0.0);
    for (int s = part.begin; s < part.end; ++s)
      Supernode(L, s).forward(x.data(), work, [&](int row, double number) {
        (row < part.end_column ? x[at(row)] : sums[place_[at(row)]]) += number;
      });
  });
  for (int k = 0; k < subtrees(); ++k)
    for (std::size_t i = 0; i < top; ++i) x[at(top_column_[i])] += sums_[at(k) * top + i];
  double* work = work_.data() + subtree_.size() * most_rows_;
  for (const int s : top_)
    Supernode(L, s).forward(x.data(), work, [&](int row, double number) { x[at(row)] += number; });
  for (std::size_t k = top_.size(); k-- > 0;) Supernode(L, top_[k]).backward(x.data(), work);
  for_subtrees([&](const Subtree& part, double* own, double*) {
    for (int s = part.end; s-- > part.begin;) Supernode(L, s).backward(x.data(), own);
  });
}

template void SupernodeSolver::solve(const Supernodes<double>&, ThreadPool*, std::span<double>);
template void SupernodeSolver::solve(const Supernodes<float>&, ThreadPool*, std::span<double>);

}  // namespace fascia
