#pragma once

#include "core/solver/multigrid.hpp"
#include "gpu/array.hpp"
#include "gpu/level_kernels.hpp"
#include "gpu/views.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace fascia::gpu {

/// The cycle of Multigrid in the memory of a space, with levels that the host made. The finest level has no matrix here
/// either: its products are the caller's.
template <class Space>
class Levels {
 public:
  /// @param nodes  of the model that the levels are of
  void take(const Multigrid& made, const NodesView& nodes);
  /// Differs after each call of take() that moved anything that loops point to.
  std::uint64_t key() const { return key_; }

  /// z = M⁻¹ r. @param product  product(x, y): loops that make y = K x of the finest level
  template <class Product>
  void cycle(const double* r, double* z, const Product& product) const {
    cycle(0, r, z, product);
  }

 private:
  struct Rows {
    Array<Space, int> begin, column;
    Array<Space, std::size_t> value_begin;
    Array<Space, double> values;
    void take(const BlockRows& rows);
    kernels::BlockRowsView view() const { return {begin.data(), column.data(), value_begin.data(), values.data()}; }
  };
  struct Level {
    kernels::LevelNodes nodes;
    Smoothing by;
    Array<Space, double> inverse;
    Rows K, P;
    Array<Space, int> column_begin, row;  ///< of P by columns
    Array<Space, std::size_t> block;
    mutable Array<Space, double> b, x, r, d, y;
    kernels::Smoother smoother() const { return {nodes, inverse.data(), by}; }
    void take(const Multigrid::LevelView& made, const kernels::LevelNodes& of, std::size_t dofs);
    void take_columns(const BlockRows& made, int coarse);
  };

  template <class Product>
  void cycle(std::size_t depth, const double* b, double* x, const Product& product) const;
  template <class Product>
  void smooth(const Level& level, const double* r, double* x, bool from_zero, const Product* product) const;
  template <class Product>
  void renew_residual(const Level& level, const double* b, double* x, const Product* product) const;

  std::vector<std::unique_ptr<Level>> levels_;
  Array<Space, double> coarsest_;  ///< inverse; none where the smoother has to do
  int dofs_ = 0;
  std::uint64_t key_ = 0;
};

/// @param product  of the finest level; null: of the level's own matrix
template <class Space>
template <class Product>
void Levels<Space>::smooth(const Level& level, const double* r, double* x, bool from_zero,
                           const Product* product) const {
  const kernels::Smoother smoother = level.smoother();
  double* d = level.d.data();
  Space::for_each(level.nodes.count, kernels::BeginSmoothing{smoother, r, d, x, from_zero});
  if (product == nullptr) {
    Space::template sum_lanes<kFrameDofs>(level.nodes.count, kernels::FrameProduct{level.K.view(), d},
                                          kernels::EndFrameSmoothing{smoother, r, d, x});
    return;
  }
  (*product)(d, level.y.data());
  Space::for_each(level.nodes.count, kernels::EndSmoothing{smoother, r, level.y.data(), d, x});
}

template <class Space>
template <class Product>
void Levels<Space>::renew_residual(const Level& level, const double* b, double* x, const Product* product) const {
  double* r = level.r.data();
  if (product == nullptr) {
    Space::template sum_lanes<kFrameDofs>(level.nodes.count, kernels::FrameProduct{level.K.view(), x},
                                          kernels::FrameDifference{b, r});
    return;
  }
  (*product)(x, level.y.data());
  Space::for_each(dofs_, kernels::Difference{b, level.y.data(), r});
}

/// x ← M⁻¹ b of a level, as Multigrid::cycle().
template <class Space>
template <class Product>
void Levels<Space>::cycle(std::size_t depth, const double* b, double* x, const Product& product) const {
  const Level& level = *levels_[depth];
  const bool last = depth + 1 == levels_.size();
  if (last && !coarsest_.empty()) {
    const int n = kFrameDofs * level.nodes.count;
    Space::template sum_lanes<1>(n, kernels::DenseProduct{n, coarsest_.data(), b}, kernels::TakeEntry{x});
    return;
  }
  const Product* finest = depth == 0 ? &product : nullptr;
  smooth(level, b, x, true, finest);
  renew_residual(level, b, x, finest);
  if (!last) {
    const Level& next = *levels_[depth + 1];
    Space::template sum_lanes<kFrameDofs>(next.nodes.count,
                                          kernels::Restrict{level.nodes, level.column_begin.data(), level.row.data(),
                                                            level.block.data(), level.P.values.data(), level.r.data()},
                                          kernels::TakeRestricted{next.b.data()});
    cycle(depth + 1, next.b.data(), next.x.data(), product);
    Space::for_each(level.nodes.count, kernels::Prolong{level.nodes, level.P.view(), next.x.data(), x});
    renew_residual(level, b, x, finest);
  }
  smooth(level, level.r.data(), x, false, finest);
}

}  // namespace fascia::gpu
