#pragma once

#include "core/base/index.hpp"
#include "core/space/array.hpp"
#include "core/space/space.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace fascia {

namespace loops {

/// Sums over a range of items.
template <int K, int M, class Item>
struct ItemRange {
  const int *order, *begin;
  Item item;

  FASCIA_HD Sums<K, M> operator()(int r) const {
    Sums<K, M> sums;
    for (int i = begin[r]; i < begin[r + 1]; ++i) item(order[i], sums);
    return sums;
  }
};

/// Sums over a range of pieces.
template <int K, int M>
struct PieceRange {
  const int* begin;
  const Sums<K, M>* pieces;

  FASCIA_HD Sums<K, M> operator()(int r) const {
    Sums<K, M> sums;
    for (int i = begin[r]; i < begin[r + 1]; ++i) sums.add(pieces[i]);
    return sums;
  }
};

template <int K, int M, class Range>
struct StorePiece {
  Range range;
  Sums<K, M>* out;
  FASCIA_HD void operator()(int piece) const { out[piece] = range(piece); }
};

template <class Range, class End>
struct EndRow {
  Range range;
  End end;
  FASCIA_HD void operator()(int row) const { end(row, range(row)); }
};

}  // namespace loops

/// Sums over the items of each row, in a fixed order: items are sorted by row; rows with many are cut into pieces, and
/// those into pieces, so that one long row does not run on one thread.
template <class Space>
class RowSums {
 public:
  RowSums() = default;
  /// @param row_of_item  −1: in none
  /// @param most         sums of a call that takes no memory, as where loops are recorded
  RowSums(const std::vector<int>& row_of_item, int rows, int most = 0, Space space = Space())
      : space_(space), rows_(rows) {
    std::vector<int> begin(at(rows) + 1, 0);
    for (const int row : row_of_item)
      if (row >= 0) ++begin[at(row) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<int> order(at(begin.back())), next(begin.begin(), begin.end() - 1);
    for (std::size_t i = 0; i < row_of_item.size(); ++i)
      if (row_of_item[i] >= 0) order[at(next[at(row_of_item[i])]++)] = static_cast<int>(i);
    order_.upload(order);
    while (cut(begin)) {
    }
    row_begin_.upload(begin);
    scratch_.resize(at(pieces_) * at(most + 1));
  }

  int rows() const { return rows_; }

  /// end(row, sums) with what item(i, sums) builds up over the row's items: K sums, then M maxima.
  template <int K, int M = 0, class Item, class End>
  void sum(const Item& item, const End& end) {
    using Total = Sums<K, M>;
    using Pieces = loops::PieceRange<K, M>;
    if (levels_.empty()) {
      const loops::ItemRange<K, M, Item> range{order_.data(), row_begin_.data(), item};
      space_.for_each(rows_, loops::EndRow<decltype(range), End>{range, end});
      return;
    }
    scratch_.resize(std::max(scratch_.size(), at(pieces_) * (sizeof(Total) / sizeof(double))));
    auto* out = reinterpret_cast<Total*>(scratch_.data());
    const loops::ItemRange<K, M, Item> items{order_.data(), levels_[0].data(), item};
    space_.for_each(count(0), loops::StorePiece<K, M, decltype(items)>{items, out});
    for (std::size_t l = 1; l < levels_.size(); ++l) {
      Total* below = out;
      out += count(l - 1);
      space_.for_each(count(l), loops::StorePiece<K, M, Pieces>{{levels_[l].data(), below}, out});
    }
    space_.for_each(rows_, loops::EndRow<Pieces, End>{{row_begin_.data(), out}, end});
  }

 private:
  static constexpr int kPiece = 32;
  int count(std::size_t level) const { return static_cast<int>(levels_[level].size()) - 1; }

  /// Cuts ranges into pieces where one is long, and makes them ranges of pieces.
  bool cut(std::vector<int>& begin) {
    int longest = 0;
    for (std::size_t r = 0; r + 1 < begin.size(); ++r) longest = std::max(longest, begin[r + 1] - begin[r]);
    if (longest <= kPiece) return false;
    std::vector<int> pieces, pieces_begin{0};
    for (std::size_t r = 0; r + 1 < begin.size(); ++r) {
      for (int i = begin[r]; i < begin[r + 1]; i += kPiece) pieces.push_back(i);
      pieces_begin.push_back(static_cast<int>(pieces.size()));
    }
    pieces_ += static_cast<int>(pieces.size());
    pieces.push_back(begin.back());
    levels_.emplace_back().upload(pieces);
    begin.swap(pieces_begin);
    return true;
  }

  Space space_;
  int rows_ = 0, pieces_ = 0;
  Array<Space, int> order_, row_begin_;
  std::vector<Array<Space, int>> levels_;  ///< where pieces begin: among items, then among the pieces before
  Array<Space, double> scratch_;
};

}  // namespace fascia
