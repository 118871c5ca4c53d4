#pragma once

#include "gpu/row_sums.hpp"

#include <vector>

namespace fascia::gpu {

/// Sums over the items of each connected part, in a fixed order.
template <class Space>
class PartSums {
 public:
  /// @param part_of_item  −1: in none
  PartSums(const std::vector<int>& part_of_item, int parts) : rows_(part_of_item, parts) {}

  /// out[(K + M) · part + k] = what item(i, sums) builds up over the part's items: sums, then maxima.
  template <int K, int M = 0, class Item>
  void sum(const Item& item, double* out) {
    rows_.template sum<K, M>(item, Store<K, M>{out});
  }

  template <int K, int M>
  struct Store {
    double* out;
    FASCIA_HD void operator()(int part, const Sums<K, M>& total) const {
      for (int k = 0; k < K; ++k) out[(K + M) * part + k] = total.v[k];
      for (int k = 0; k < M; ++k) out[(K + M) * part + K + k] = total.largest[k];
    }
  };

 private:
  RowSums<Space> rows_;
};

}  // namespace fascia::gpu
