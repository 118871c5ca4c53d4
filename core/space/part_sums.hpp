#pragma once

#include "core/space/row_sums.hpp"

#include <vector>

namespace fascia {

namespace loops {

/// The items of one part, in their order.
template <int K, int M, class Item>
struct ItemOf {
  const int* order;
  Item item;
  FASCIA_HD void operator()(int i, Sums<K, M>& sums) const { item(order[i], sums); }
};

}  // namespace loops

/// Sums over the items of each connected part, in a fixed order: of a few parts one after the other, each over all of
/// the device; of many all at once.
template <class Space>
class PartSums {
 public:
  /// @param part_of_item  −1: in none
  PartSums(const std::vector<int>& part_of_item, int parts, Space space = Space()) : space_(space) {
    if (parts > kFew) {
      rows_ = RowSums<Space>(part_of_item, parts, 0, space);
      return;
    }
    std::vector<int> order;
    for (int part = 0; part < parts; ++part) {
      for (std::size_t i = 0; i < part_of_item.size(); ++i)
        if (part_of_item[i] == part) order.push_back(static_cast<int>(i));
      begin_.push_back(static_cast<int>(order.size()));
    }
    order_.upload(order);
  }

  /// out[(K + M) · part + k] = what item(i, sums) builds up over the part's items: sums, then maxima.
  template <int K, int M = 0, class Item>
  void sum(const Item& item, double* out) {
    if (rows_.rows() > 0) {
      rows_.template sum<K, M>(item, Store<K, M>{out});
      return;
    }
    for (std::size_t part = 0; part + 1 < begin_.size(); ++part)
      space_.template sum<K, M>(begin_[part + 1] - begin_[part],
                                loops::ItemOf<K, M, Item>{order_.data() + begin_[part], item},
                                StoreOne<K, M>{{out}, static_cast<int>(part)});
  }

  template <int K, int M>
  struct Store {
    double* out;
    FASCIA_HD void operator()(int part, const Sums<K, M>& total) const {
      for (int k = 0; k < K; ++k) out[(K + M) * part + k] = total.v[k];
      for (int k = 0; k < M; ++k) out[(K + M) * part + K + k] = total.largest[k];
    }
  };
  template <int K, int M>
  struct StoreOne {
    Store<K, M> store;
    int part;
    FASCIA_HD void operator()(const Sums<K, M>& total) const { store(part, total); }
  };

 private:
  static constexpr int kFew = 8;
  Space space_;
  std::vector<int> begin_{0};
  Array<Space, int> order_;
  RowSums<Space> rows_;
};

}  // namespace fascia
