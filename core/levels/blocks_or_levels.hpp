#pragma once

#include "core/linear/cg.hpp"

#include <algorithm>

namespace fascia {

/// Chooses between blocks and levels of rigid frames as preconditioner where the user leaves it open. Iterations are
/// counted, no clock is read, so that a run can be repeated.
///
/// Blocks go first, for about half as long as levels would take: whichever is right, little more than twice its time is
/// spent. In a solve that needs many times as long they gain nothing at first, for each iteration couples nodes that
/// are one further from one another: such a solve of the processor goes on with levels after a few iterations. Levels
/// that turn out far more expensive hand back to blocks, which may then take as long as those did.
class BlocksOrLevels {
 public:
  /// Both in iterations with blocks; of a processor unless said. There a cycle takes 5 to 12 and making 50 (quadratic
  /// elements) to 300, from 900 unknowns to 70,000, on one thread of an EPYC and of a Xeon.
  struct Costs {
    double cycle = 8;     ///< an iteration with levels
    double making = 200;  ///< of levels
  };
  explicit BlocksOrLevels(const Costs& costs) : costs_(costs), patience_(expected() / 2) {}

  bool levels() const { return levels_; }
  /// Cost of a solve with levels as it is expected before the first, and of the last ones, a moving average: in
  /// iterations with blocks.
  double expected() const { return costs_.making + kCycles * costs_.cycle; }
  double recent() const { return recent_; }
  /// Levels have taken longer than was expected of them, in more than a solve or two.
  bool disappoint() const { return solves_ >= kMemory && recent_ > expected(); }
  /// Iterations that blocks get in a solve before levels take their place.
  int patience() const { return static_cast<int>(std::min(patience_, 1e9)); }
  /// Limits a solve by blocks to that, and lets it end earlier where it gains nothing.
  CgOptions limited(CgOptions options) const {
    options.max_iterations = std::min(options.max_iterations, patience());
    options.look = handed_back_ ? 0 : kLook;
    options.hope = kHope;
    return options;
  }
  void turn_to_levels() {
    levels_ = true;
    solves_ = 0;
  }
  void turn_to_blocks() { levels_ = false; }
  /// Takes the cost of a solve with levels into account. @param made  how often levels were made for it
  void took(int iterations, int made) {
    const double cost = costs_.cycle * iterations + costs_.making * made;
    recent_ = solves_ == 0 ? cost : recent_ + (cost - recent_) / kMemory;
    if (++solves_ < kMemory || recent_ < kTooMuch * patience_) return;
    levels_ = false;
    handed_back_ = true;
    patience_ = recent_;
  }

 private:
  static constexpr double kCycles = 16;  ///< of a solve
  static constexpr int kMemory = 4;      ///< solves
  static constexpr double kTooMuch = 4;
  /// Blocks leave so much after 20 iterations: 0.03 to 0.2 in solves that take them 60, 0.8 to 2.6 in those of statics
  /// that take them 350 to 1,200.
  static constexpr int kLook = 20;
  static constexpr double kHope = 0.5;

  Costs costs_;
  double patience_;
  double recent_ = 0;  ///< cost of a solve with levels, a moving average
  int solves_ = 0;     ///< with levels in a row
  bool levels_ = false, handed_back_ = false;
};

}  // namespace fascia
