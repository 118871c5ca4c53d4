#pragma once

#include "core/math/tridiagonal.hpp"
#include "core/node/node_mode.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fascia {

/// The stable step of central differences at a state that changes: the largest eigenvalue of M⁻¹ K by a few Lanczos
/// products, from the vector that the last state had, with a little of all others. It is found from below.
///
/// Vectors are kept by an Operator:
///   begin(inverse_step)    takes the state, with the viscous stress of that 1/dt
///   add_noise(part)        y₀ ← y₀ + `part` of a vector of length 1 in all directions
///   normalize(k)           v ← M⁻¹ yₖ; returns v · yₖ
///   scale(k, s)            yₖ and v ← s times themselves
///   product()              w ← K v; returns v · w
///   advance(k, a, b)       yₖ₊₁ ← w − a yₖ − b yₖ₋₁
///   combine(s, count)      y₀ ← Σ sₖ yₖ
class FastestMode {
 public:
  /// The stable step, without a margin [s]; infinite where nothing is stiff. @param about  what it is about
  template <class Operator>
  double stable_step(Operator& op, double about, bool damped) {
    op.begin(damped ? 2 / about : 0.0);
    const double squared = find(op);
    if (std::isnan(squared)) return squared;
    if (squared <= 0) return std::numeric_limits<double>::infinity();
    if (!damped) return 2 / std::sqrt(squared);
    // dt² K + 2 dt C = 4 along the mode.
    op.begin(0);
    op.scale(0, 1 / std::sqrt(op.normalize(0)));
    const double elastic = std::max(0.0, op.product());
    const double viscous = 0.5 * about * std::max(0.0, squared - elastic);
    return 4 / (viscous + std::sqrt(viscous * viscous + 4 * elastic));
  }

 private:
  static constexpr int kFirstRounds = 12, kRounds = 2;
  static constexpr double kFresh = 0.1, kSettled = 3e-3;

  template <class Operator>
  double find(Operator& op) {
    op.add_noise(started_ ? kFresh : 1.0);
    const int rounds = started_ ? kRounds : kFirstRounds;
    double found = round(op);
    for (int k = 1; k < rounds && !(started_ && settled_) && !std::isnan(found); ++k) {
      const double next = round(op);
      const bool settled = !(next - found > kSettled * next);
      found = std::isnan(next) ? next : std::max(found, next);
      if (settled) break;
    }
    started_ = true;
    return found;
  }

  /// The largest Ritz value of a few products; its vector is y₀ then.
  template <class Operator>
  double round(Operator& op) {
    std::array<double, kModeBasis> diagonal{}, off{};
    double found = 0;
    int count = 0;
    for (int k = 0; k < kModeBasis; ++k) {
      const double beta = std::sqrt(std::max(0.0, op.normalize(k)));
      if (!(beta > 1e-8 * std::abs(found))) break;
      const auto i = static_cast<std::size_t>(k);
      if (k > 0) off[i - 1] = beta;
      op.scale(k, 1 / beta);
      diagonal[i] = op.product();
      if (std::isnan(diagonal[i])) return diagonal[i];
      count = k + 1;
      const double next = largest_eigenvalue({diagonal.data(), i + 1}, {off.data(), i});
      settled_ = k > 1 && next - found <= kSettled * next;
      found = next;
      if (settled_ || count == kModeBasis) break;
      op.advance(k, diagonal[i], k > 0 ? beta : 0.0);
    }
    if (count == 0) return 0;
    const auto n = static_cast<std::size_t>(count);
    op.combine(largest_eigenvector({diagonal.data(), n}, {off.data(), n - 1}, found).data(), count);
    return found;
  }

  bool started_ = false;
  bool settled_ = false;  ///< the last product of the last round added next to nothing
};

}  // namespace fascia
