#pragma once

#include "core/math/index.hpp"
#include "gpu/array.hpp"
#include "gpu/space.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

namespace fascia::gpu {

/// Sums over the items of each connected part, in a fixed order: items are sorted by part and cut into pieces.
template <class Space>
class PartSums {
 public:
  /// @param part_of_item  −1: in none
  PartSums(const std::vector<int>& part_of_item, int parts) : parts_(parts) {
    std::vector<int> order, begin, piece_part, part_piece(at(parts + 1), 0);
    for (int i = 0; i < static_cast<int>(part_of_item.size()); ++i)
      if (part_of_item[at(i)] >= 0) order.push_back(i);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return part_of_item[at(a)] < part_of_item[at(b)]; });
    for (int i = 0; i < static_cast<int>(order.size()); ++i) {
      const int part = part_of_item[at(order[at(i)])];
      if (i == 0 || part != piece_part.back() || i - begin.back() == kPiece) {
        begin.push_back(i);
        piece_part.push_back(part);
      }
    }
    for (const int part : piece_part) ++part_piece[at(part + 1)];
    std::partial_sum(part_piece.begin(), part_piece.end(), part_piece.begin());
    pieces_ = static_cast<int>(begin.size());
    begin.push_back(static_cast<int>(order.size()));
    order_.upload(order);
    begin_.upload(begin);
    part_piece_.upload(part_piece);
  }

  /// out[(K + M) · part + k] = what item(i, sums) builds up over the part's items: sums, then maxima.
  template <int K, int M = 0, class Item>
  void sum(const Item& item, double* out) {
    piece_sums_.resize(at(pieces_) * sizeof(Sums<K, M>) / sizeof(double));
    auto* pieces = reinterpret_cast<Sums<K, M>*>(piece_sums_.data());
    const int* part_piece = part_piece_.data();
    Space::for_each(pieces_, PieceBody<K, M, Item>{order_.data(), begin_.data(), pieces, item});
    Space::for_each(parts_, [part_piece, pieces, out] FASCIA_HD(int part) {
      Sums<K, M> total;
      for (int p = part_piece[part]; p < part_piece[part + 1]; ++p) total.add(pieces[p]);
      for (int k = 0; k < K; ++k) out[(K + M) * part + k] = total.v[k];
      for (int k = 0; k < M; ++k) out[(K + M) * part + K + k] = total.largest[k];
    });
  }

  template <int K, int M, class Item>
  struct PieceBody {
    const int *order, *begin;
    Sums<K, M>* pieces;
    Item item;
    FASCIA_HD void operator()(int p) const {
      Sums<K, M> sums;
      for (int i = begin[p]; i < begin[p + 1]; ++i) item(order[i], sums);
      pieces[p] = sums;
    }
  };

 private:
  static constexpr int kPiece = 32;
  int parts_, pieces_ = 0;
  Array<Space, int> order_, begin_, part_piece_;
  Array<Space, double> piece_sums_;
};

}  // namespace fascia::gpu
