#pragma once

#include "core/base/thread_pool.hpp"
#include "meshless/scattered/scattered_weights.hpp"

#include <cstddef>
#include <functional>
#include <vector>

namespace fascia {

/// Weights at many places, one after the other in a few arrays: they are asked for again in every state that is saved.
class KeptWeights {
 public:
  KeptWeights() = default;
  /// @param weights  of a place; all threads ask for some. What it throws reaches the caller
  KeptWeights(std::size_t count, const std::function<ScatteredWeights(std::size_t)>& weights, ThreadPool& pool);

  std::size_t size() const { return spread_.size(); }
  bool empty() const { return size() == 0; }
  WeightsView operator[](std::size_t place) const;

 private:
  std::vector<std::size_t> begin_;  ///< (places + 1), in the next three
  std::vector<int> frame_;
  std::vector<double> w_;
  std::vector<Vec3d> gradient_;
  std::vector<Mat3d> consistent_;  ///< (places), or one that is that of all
  std::vector<char> lowered_;      ///< (places), as the next one
  std::vector<double> spread_;
};

/// How far weights are from linear consistency: root mean squares over places.
struct Consistency {
  double position = 0;  ///< |Σ w_i x_i − X| / spacing [-]
  double gradient = 0;  ///< |Σ x_i ∇w_iᵀ T Tᵀ − T Tᵀ| / |T Tᵀ|: error of F relative to a uniform stretch, at R = I [-]
};

/// @param weights          of each place; places without weights are left out
/// @param frame_positions  by the frames' numbers [m]
/// @param spacing          of the frames [m]
Consistency consistency(const KeptWeights& weights, std::span<const Vec3d> frame_positions,
                        std::span<const ScatteredPlace> places, double spacing);

}  // namespace fascia
