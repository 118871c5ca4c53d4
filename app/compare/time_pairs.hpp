#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace fascia::app {

/// Times of a result are load factors, steps of a path that is followed, numbers of modes, or seconds.
enum class RunKind { statics, path, modes, dynamics };

/// A time of a result: at an entry, or between two.
struct TimePlace {
  std::size_t below = 0, above = 0;
  double fraction = 0;  ///< of the way from the one to the other
};

/// A time at which two results are compared.
struct TimePair {
  double time = 0;
  TimePlace a, b;
};

struct TimePairs {
  std::vector<TimePair> pairs;
  std::vector<std::string> structure;  ///< sentences: what only one has
  std::vector<std::string> notes;      ///< sentences: what was done
};

/// Pairs the times of two results. Dynamics: each time of the result that has fewer, interpolated linearly between two
/// of the other where it has not that time itself, as far as both reach. Statics and modes: the times that both have.
/// Paths, results of different kinds, and statics without a common load factor: the last ones.
/// @param entries  "states", "rows of probes.csv"; for the sentences
TimePairs pair_times(const std::vector<double>& a, RunKind kind_a, const std::vector<double>& b, RunKind kind_b,
                     const std::string& entries);

}  // namespace fascia::app
