#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fascia::app {

/// How long the steps of a run took, in memory that does not grow with their number: they are counted in classes a
/// hundredth wide, from a nanosecond to more than a year.
class StepSeconds {
 public:
  /// @param seconds  of one step [s]
  void add(double seconds);

  /// The time that this part of the steps does not exceed, to half a hundredth [s]; 0 where there was no step. The
  /// shortest and the longest time are exact.
  /// @param part  0 to 1
  double percentile(double part) const;

 private:
  std::vector<std::uint64_t> count_;  ///< of each class; empty before the first step
  std::uint64_t steps_ = 0;
  double shortest_ = 0, longest_ = 0;  ///< [s]
};

}  // namespace fascia::app
