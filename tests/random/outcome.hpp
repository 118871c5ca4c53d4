#pragma once

#include "tests/random/draws.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace fascia::random_scenes {

/// A probe in the results of a run.
struct Measured {
  std::string quantity, unit;
  std::vector<std::vector<double>> rows;  ///< a saved step each
  const std::vector<double>& last() const { return rows.back(); }
};

/// How a run of the program ended and what it left.
struct Outcome {
  int exit_status = -1;
  bool timed_out = false;
  std::string message;  ///< on standard error
  Json summary;         ///< null where there is none
  std::string csv;      ///< probes.csv
  std::vector<double> times;
  std::map<std::string, Measured> probes;
  double seconds = 0;  ///< of a processor

  std::string status() const { return summary.is_object() ? summary.value("status", "") : ""; }
  /// The part of the largest of loads, inertia and reactions that is left out of balance, or may be by rounding.
  double residual() const;
  /// True where the program itself says that the end is not the only one, or not for sure.
  bool says_several_ends() const;
  /// It says why another run may find another solution (`doubts`), which most do not.
  bool doubts_its_end() const;
  /// The largest absolute value of a unit in all rows.
  double largest(const std::string& unit) const;
};

/// Runs a scene in a process of its own.
Outcome run(const std::string& scene, const std::filesystem::path& folder);

}  // namespace fascia::random_scenes
