#pragma once

#include "core/base/index.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace fascia {

/// Numbers from 0 in sets that only grow together; a set's root is its lowest number.
class DisjointSets {
 public:
  explicit DisjointSets(int count) : parent_(at(count)) { std::iota(parent_.begin(), parent_.end(), 0); }

  int root(int i) {
    while (parent_[at(i)] != i) {
      int& up = parent_[at(i)];
      i = up = parent_[at(up)];
    }
    return i;
  }

  void join(int i, int j) {
    const int a = root(i), b = root(j);
    parent_[at(std::max(a, b))] = std::min(a, b);
  }

  /// How many sets there are.
  int sets() const {
    int roots = 0;
    for (std::size_t i = 0; i < parent_.size(); ++i) roots += parent_[i] == static_cast<int>(i) ? 1 : 0;
    return roots;
  }

 private:
  std::vector<int> parent_;
};

}  // namespace fascia
