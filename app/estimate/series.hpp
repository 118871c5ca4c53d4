#pragma once

#include "assembly/simulation/simulation.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// A quantity over the saved times of a run: of statics at its end alone, of modes all at once.
struct Series {
  std::vector<double> times;
  std::vector<std::vector<double>> values;  ///< components, one list a time

  /// The largest |value| over time.
  double largest() const;
};

/// How components are one number.
enum class SeriesNorm {
  euclidean,
  largest_relative  ///< the largest component of the difference, each relative to that of the first series
};

/// The largest |a − b| over the times that both have; none where they share no time or have other components.
std::optional<double> distance(const Series& a, const Series& b, SeriesNorm norm);

/// Adds factor |a − b| of the components at the last time that both have.
void add_last_difference(const Series& a, const Series& b, double factor, std::vector<double>& to);

/// a + factor (b − a) at the times that both have.
Series mixed(const Series& a, const Series& b, double factor);

/// Columns of probes.csv whose names begin with a probe's name.
/// @param over_time  all rows; otherwise the last one
/// @param by_mode    the rows are the components
/// @throws FileError, InputError  as io::read_number_table
class ProbeTable {
 public:
  explicit ProbeTable(const std::filesystem::path& directory);
  Series series(const std::string& probe, SolverKind kind) const;

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<double>> rows_;
};

}  // namespace fascia::app
