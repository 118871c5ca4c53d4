#include "core/linear/supernodal_factor.hpp"

#include "core/base/index.hpp"
#include "core/linear/panel_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

namespace fascia {

namespace {

constexpr int kMostRows = 384;  ///< of a part of a supernode: what a thread works at stays in its cache
constexpr int kDepth = 128;     ///< columns that a product sums at a time
constexpr std::size_t kBlock = kMostDofs * kMostDofs;
/// A pivot below this part of the matrix's own number there is rounding: it has no digit, nor a sign.
constexpr double kVanished = std::numeric_limits<double>::epsilon();

}  // namespace

SupernodalFactor::SupernodalFactor(const BlockMatrix& pattern, const DofFilter& filter, const EliminationOrder& order,
                                   ThreadPool* pool)
    : filter_(filter),
      pattern_(pattern, filter, order.nodes),
      pool_(pool),
      tasks_(pattern_, pool == nullptr ? 1 : pool->size(), kMostRows),
      scratch_(at(tasks_.threads())) {
  list_entries(pattern);
}

void SupernodalFactor::list_entries(const BlockMatrix& pattern) {
  const auto for_entries = [&](const auto& act) {
    for (int i = 0; i < pattern.rows(); ++i) {
      const int own = pattern_.position[at(i)];
      if (own < 0) continue;
      for (int k = pattern.diagonal(i); k < pattern.row_begin(i + 1); ++k) {
        const int other = pattern_.position[at(pattern.columns(i)[at(k - pattern.row_begin(i))])];
        if (other >= own) act(own, Entry{k, other});
        if (other >= 0 && other < own) act(other, Entry{k, ~own});
      }
    }
  };
  entry_begin_.assign(pattern_.node.size() + 1, 0);
  for_entries([&](int column, const Entry&) { ++entry_begin_[at(column + 1)]; });
  for (std::size_t k = 1; k < entry_begin_.size(); ++k) entry_begin_[k] += entry_begin_[k - 1];
  entry_.resize(entry_begin_.back());
  std::vector<std::size_t> next(entry_begin_.begin(), entry_begin_.end() - 1);
  for_entries([&](int column, const Entry& entry) { entry_[next[at(column)]++] = entry; });
  for (const int node : pattern_.node) fixed_.push_back(filter_.fixed_of(node));
}

SupernodalFactor::Room SupernodalFactor::room() const {
  int rows = 0, columns = 0;
  for (int s = 0; s < pattern_.supernodes(); ++s) {
    rows = std::max(rows, pattern_.rows(s));
    columns = std::max(columns, pattern_.columns(s));
  }
  return {at(panel::padded(std::min(rows, kMostRows)) + panel::kTileRows), at(columns)};
}

double SupernodalFactor::bytes() const {
  const Room room = this->room();
  const double scratch = static_cast<double>(sizeof(double) * (room.rows * (2 * room.columns + at(kDepth)) +
                                                               room.columns * room.columns)) +
                         sizeof(int) * static_cast<double>(pattern_.columns());
  return sizeof(double) * static_cast<double>(size() + 2 * at(pattern_.columns())) +
         scratch * static_cast<double>(scratch_.size());
}

int SupernodalFactor::negative_pivots() const { return static_cast<int>(std::count(sign_.begin(), sign_.end(), -1.0)); }

double SupernodalFactor::smallest_pivot() const {
  double smallest = std::numeric_limits<double>::infinity();
  for (int s = 0; s < pattern_.supernodes(); ++s)
    for (int j = 0; j < pattern_.columns(s); ++j) {
      const double number = values_of(s)[at(j) * at(pattern_.rows(s) + 1)];
      smallest = std::min(smallest, number * number / least_[at(pattern_.first_column[at(s)] + j)]);
    }
  return kVanished * smallest;
}

bool SupernodalFactor::factorize(const BlockMatrix& matrix, Pivots pivots, double shift,
                                 const BlockMatrix* shift_from) {
  sign_.assign(pivots == Pivots::any ? at(pattern_.columns()) : 0, 1.0);
  if (values_ == nullptr) {
    std::unique_ptr<double[], AlignedDelete> values(new (std::align_val_t{64}) double[size()]);
    const Room room = this->room();
    for (Scratch& s : scratch_) {
      s.panel.resize(room.rows * room.columns);
      s.product.resize(room.rows * room.columns);
      s.left.resize(room.rows * std::min(room.columns, at(kDepth)));
      s.right.resize(room.columns * room.columns);
      s.place.resize(at(pattern_.columns()));
      s.rows.resize(room.rows);
    }
    least_.resize(at(pattern_.columns()));
    values_ = std::move(values);  // all is there
  }
  source_ = {&matrix, shift, shift_from};
  failed_ = false;
  if (tasks_.empty())
    for (int s = 0; s < pattern_.supernodes() && !failed_; ++s) make_supernode(s, scratch_[0]);
  else
    tasks_.run(*pool_, [&](const FactorTasks::Task& task, int thread) { make(task, scratch_[at(thread)]); });
  return !failed_;
}

void SupernodalFactor::make_supernode(int s, Scratch& scratch) {
  const int rows = pattern_.rows(s);
  for (int begin = 0; begin < rows; begin += kMostRows) {
    if (failed_.load(std::memory_order_relaxed)) return;
    const int end = std::min(rows, begin + kMostRows);
    gather(s, begin, end, scratch);
    divide(s, begin, end, scratch);
    store(s, begin, end, scratch);
  }
}

void SupernodalFactor::make(const FactorTasks::Task& task, Scratch& scratch) {
  using Kind = FactorTasks::Kind;
  if (failed_.load(std::memory_order_relaxed)) return;
  if (task.kind == Kind::subtree) {
    for (int s = task.begin; s < task.end; ++s) make_supernode(s, scratch);
    return;
  }
  if (task.kind == Kind::gather) {
    gather(task.supernode, task.begin, task.end, scratch);
  } else {
    load(task.supernode, task.begin, task.end, scratch);
    divide(task.supernode, task.begin, task.end, scratch);
  }
  store(task.supernode, task.begin, task.end, scratch);
}

/// Takes what the matrix has there, and subtracts the products of all columns before.
void SupernodalFactor::gather(int s, int begin, int end, Scratch& scratch) {
  const int columns = pattern_.columns(s), first_column = pattern_.first_column[at(s)];
  const std::size_t stride = at(panel::padded(end - begin));
  if (scratch.placed != s) {
    const int* row = pattern_.rows_of(s);
    for (int i = 0; i < pattern_.rows(s); ++i) scratch.place[at(row[i])] = i;
    scratch.placed = s;
  }
  std::fill_n(scratch.panel.begin(), stride * at(columns), 0.0);
  add_matrix(s, begin, end, scratch);
  for (int j = 0; begin == 0 && j < columns; ++j)
    least_[at(first_column + j)] = kVanished * std::abs(scratch.panel[at(j) * (stride + 1)]);
  for (std::int64_t d = pattern_.descendant_begin[at(s)]; d < pattern_.descendant_begin[at(s + 1)]; ++d)
    subtract(s, begin, end, pattern_.descendant[static_cast<std::size_t>(d)], scratch);
}

void SupernodalFactor::add_matrix(int s, int begin, int end, Scratch& scratch) const {
  constexpr double kLeast = 1e-3;  // rows that nothing resists need a shift too
  const DofLayout& dofs = source_.matrix->dofs();
  const std::size_t stride = at(panel::padded(end - begin));
  double turned[kBlock], diagonal[kBlock];
  for (int k = pattern_.first_node[at(s)]; k < pattern_.first_node[at(s + 1)]; ++k) {
    const int node = pattern_.node[at(k)];
    double* first = scratch.panel.data() + at(pattern_.column[at(k)] - pattern_.first_column[at(s)]) * stride;
    for (std::size_t e = entry_begin_[at(k)]; e < entry_begin_[at(k + 1)]; ++e) {
      const bool flipped = entry_[e].row < 0;
      const int row = flipped ? ~entry_[e].row : entry_[e].row;
      const int place = scratch.place[at(pattern_.column[at(row)])] - begin;  // parts may end within a node
      if (place + pattern_.column[at(row + 1)] <= pattern_.column[at(row)] || place >= end - begin) continue;
      const int other = pattern_.node[at(row)], upper = flipped ? other : node, lower = flipped ? node : other;
      filter_.rotate_block(upper, lower, source_.matrix->block(entry_[e].block), turned);
      const int n = dofs.size(lower), columns = dofs.size(node), rows = dofs.size(other);
      if (row == k && source_.shift != 0) {
        filter_.rotate_block(node, node, source_.shift_from->block(source_.shift_from->diagonal(node)), diagonal);
        double largest[2] = {0, 0};  // of displacements, of rotations
        for (int i = 0; i < n; ++i) largest[i / 3 > 0] = std::max(largest[i / 3 > 0], std::abs(diagonal[(n + 1) * i]));
        for (int i = 0; i < n; ++i)
          turned[(n + 1) * i] += source_.shift * std::max(std::abs(diagonal[(n + 1) * i]), kLeast * largest[i / 3 > 0]);
      }
      double* column = first;
      for (int j = 0; j < columns; ++j) {
        if ((fixed_[at(k)] >> j & 1U) != 0) continue;
        for (int i = 0, to = place; i < rows; ++i) {
          if ((fixed_[at(row)] >> i & 1U) != 0) continue;
          if (to >= 0 && to < end - begin) column[to] += turned[flipped ? i * n + j : j * n + i];
          ++to;
        }
        column += stride;
      }
    }
  }
}

/// L_d S L_dᵀ of a supernode d before, of its rows among those here and among these columns.
void SupernodalFactor::subtract(int s, int begin, int end, const FactorPattern::Descendant& from,
                                Scratch& scratch) const {
  const int d = from.supernode, all = pattern_.rows(d), depth = pattern_.columns(d);
  const int *rows = pattern_.rows_of(d), *rows_end = rows + all, *own = pattern_.rows_of(s);
  const int first_column = pattern_.first_column[at(s)];
  const int *a = rows + from.begin, *b = std::lower_bound(a, rows_end, pattern_.first_column[at(s + 1)]);
  const int* u = begin == 0 ? a : std::lower_bound(a, rows_end, own[begin]);
  const int* v = end == pattern_.rows(s) ? rows_end : std::lower_bound(u, rows_end, own[end]);
  const int m = static_cast<int>(v - u), n = static_cast<int>(b - a);
  if (m == 0) return;

  for (int i = 0; i < m; ++i) scratch.rows[at(i)] = scratch.place[at(u[i])] - begin;
  const int* place = scratch.rows.data();
  const std::size_t target = at(panel::padded(end - begin));
  // Where rows and columns lie without gaps, which may differ from part to part; deeper products are summed apart in
  // any case, so that all parts round alike. Registers may reach beyond m rows, into the next column: minus zero.
  const bool in_place = depth <= kDepth && place[m - 1] - place[0] == m - 1 && b[-1] - a[0] == n - 1;
  const std::size_t stride = in_place ? target : at(panel::padded(m));
  double* c = in_place ? scratch.panel.data() + at(a[0] - first_column) * target + place[0] : scratch.product.data();
  if (!in_place) std::fill_n(c, stride * at(n), 0.0);
  for (int first = 0; first < depth; first += kDepth) {
    const int k = std::min(kDepth, depth - first);
    const double* values = values_of(d) + at(first) * at(all);
    panel::pack_left(values + (u - rows), at(all), m, k, scratch.left.data());
    panel::pack_right(values + (a - rows), at(all), n, k, sign_from(pattern_.first_column[at(d)] + first),
                      scratch.right.data());
    panel::subtract_product(m, n, k, {scratch.left.data()}, scratch.right.data(), c, stride, u == a);
  }
  if (in_place) return;
  for (int j = 0; j < n; ++j) {
    double* to = scratch.panel.data() + at(a[j] - first_column) * target;
    const double* sum = c + at(j) * stride;
    for (int i = u == a ? j : 0; i < m; ++i) to[place[i]] += sum[i];
  }
}

void SupernodalFactor::divide(int s, int begin, int end, Scratch& scratch) {
  const int columns = pattern_.columns(s), first_column = pattern_.first_column[at(s)];
  const std::size_t stride = at(panel::padded(end - begin));
  if (begin > 0)
    return panel::solve_rows(scratch.panel.data(), stride, end - begin, columns, values_of(s), at(pattern_.rows(s)),
                             sign_from(first_column), scratch.right.data());
  double* sign = sign_.empty() ? nullptr : sign_.data() + first_column;
  if (!panel::factorize_diagonal(scratch.panel.data(), stride, end, columns, sign, least_.data() + first_column,
                                 scratch.right.data()))
    failed_.store(true, std::memory_order_relaxed);
}

void SupernodalFactor::load(int s, int begin, int end, Scratch& scratch) const {
  const std::size_t rows = at(pattern_.rows(s)), stride = at(panel::padded(end - begin));
  for (int j = 0; j < pattern_.columns(s); ++j) {
    double* to = scratch.panel.data() + at(j) * stride;
    to = std::copy_n(values_of(s) + at(j) * rows + at(begin), end - begin, to);
    std::fill(to, scratch.panel.data() + at(j + 1) * stride, 0.0);
  }
}

void SupernodalFactor::store(int s, int begin, int end, const Scratch& scratch) {
  const std::size_t rows = at(pattern_.rows(s)), stride = at(panel::padded(end - begin));
  for (int j = 0; j < pattern_.columns(s); ++j)
    std::copy_n(scratch.panel.data() + at(j) * stride, end - begin, values_of(s) + at(j) * rows + at(begin));
}

}  // namespace fascia
