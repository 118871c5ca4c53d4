#pragma once

#include "core/levels/multigrid.hpp"
#include "core/space/array.hpp"
#include "gpu/space/views.hpp"
#include "gpu/system/level_kernels.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace fascia::gpu {

/// The cycle of Multigrid in the memory of a space, with levels that the host made. Its finest level is the matrix that
/// they were made of: its products take a tenth of those that go through points and elements where a model is small,
/// and a cycle stays definite whatever became of the tangent since.
template <class Space>
class Levels {
 public:
  /// @param nodes  of the model that the levels are of
  void take(const Multigrid& made, const NodesView& nodes);
  void clear() {
    ++key_;
    levels_.clear();
    coarsest_ = {};
  }
  /// Differs after each call of take() and clear().
  std::uint64_t key() const { return key_; }

  /// z = M⁻¹ r
  void cycle(const double* r, double* z) const { cycle(0, r, z); }

 private:
  struct Rows {
    Array<Space, int> begin, column, before;
    Array<Space, std::size_t> value_begin;
    Array<Space, double> values;
    void take(const BlockRows& rows);
    void take(const FineRows& rows);
    kernels::BlockRowsView view() const {
      return {begin.data(), column.data(), before.data(), value_begin.data(), values.data()};
    }
  };
  struct Level {
    kernels::LevelNodes nodes;
    int largest_node = kFrameDofs;  ///< degrees of freedom
    Smoothing by;
    Array<Space, double> inverse;
    Rows K, P;
    Array<Space, int> column_begin, row;  ///< of P by columns
    Array<Space, std::size_t> block;
    mutable Array<Space, double> b, x, r, d;
    kernels::Smoother smoother() const { return {nodes, inverse.data(), by}; }
    void take(const Multigrid::LevelView& made, const kernels::LevelNodes& of, std::size_t dofs);
    void take_columns(const BlockRows& made, int coarse);
  };

  /// K x by nodes, each ended by end(node, sums).
  template <template <int> class End, class... Of>
  static void multiply(const Level& level, const double* x, const Of&... end);
  void cycle(std::size_t depth, const double* b, double* x) const;
  void smooth(const Level& level, const double* r, double* x, bool from_zero) const;
  void renew_residual(const Level& level, const double* b, double* x) const;

  std::vector<std::unique_ptr<Level>> levels_;
  Array<Space, double> coarsest_;  ///< inverse; none where the smoother has to do
  std::uint64_t key_ = 0;
};

template <class Space>
template <template <int> class End, class... Of>
void Levels<Space>::multiply(const Level& level, const double* x, const Of&... end) {
  const auto sized = [&]<int N>(std::integral_constant<int, N> /*largest*/) {
    Space::template sum_lanes<N>(level.nodes.count, kernels::LevelProduct<N>{level.nodes, level.K.view(), x},
                                 End<N>{end...});
  };
  if (level.largest_node <= 3)
    sized(std::integral_constant<int, 3>{});
  else if (level.largest_node <= kFrameDofs)
    sized(std::integral_constant<int, kFrameDofs>{});
  else
    sized(std::integral_constant<int, kMostDofs>{});
}

template <class Space>
void Levels<Space>::smooth(const Level& level, const double* r, double* x, bool from_zero) const {
  const kernels::Smoother smoother = level.smoother();
  double* d = level.d.data();
  Space::for_each(level.nodes.count, kernels::BeginSmoothing{smoother, r, d, x, from_zero});
  multiply<kernels::EndSmoothing>(level, d, smoother, r, d, x);
}

template <class Space>
void Levels<Space>::renew_residual(const Level& level, const double* b, double* x) const {
  multiply<kernels::Difference>(level, x, level.nodes, b, level.r.data());
}

/// x ← M⁻¹ b of a level, as Multigrid::cycle().
template <class Space>
void Levels<Space>::cycle(std::size_t depth, const double* b, double* x) const {
  const Level& level = *levels_[depth];
  const bool last = depth + 1 == levels_.size();
  if (last && !coarsest_.empty()) {
    const int n = kFrameDofs * level.nodes.count;
    Space::template sum_lanes<1>(n, kernels::DenseProduct{n, coarsest_.data(), b}, kernels::TakeEntry{x});
    return;
  }
  smooth(level, b, x, true);
  renew_residual(level, b, x);
  for (int k = 0; !last && k < corrections(depth, levels_.size()); ++k) {
    const Level& next = *levels_[depth + 1];
    Space::template sum_lanes<kFrameDofs>(next.nodes.count,
                                          kernels::Restrict{level.nodes, level.column_begin.data(), level.row.data(),
                                                            level.block.data(), level.P.values.data(), level.r.data()},
                                          kernels::TakeRestricted{next.b.data()});
    cycle(depth + 1, next.b.data(), next.x.data());
    Space::for_each(level.nodes.count, kernels::Prolong{level.nodes, level.P.view(), next.x.data(), x});
    renew_residual(level, b, x);
  }
  smooth(level, level.r.data(), x, false);
}

}  // namespace fascia::gpu
