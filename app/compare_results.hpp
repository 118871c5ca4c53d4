#pragma once

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace fascia::app {

/// How far one quantity of two results is apart.
struct QuantityDifference {
  std::string name;     ///< a probe, or "BODY: FIELD"
  double relative = 0;  ///< largest difference over all times, over the largest magnitude of the quantity in either;
                        ///< 0 where it is rounding: 1e-13 of lengths, of 1 (strains, turns), of the modulus
  double absolute = 0;  ///< that difference, in the quantity's own unit
  double at = 0;        ///< its time
  std::size_t numbers = 0;  ///< compared
};

/// What distinguishes two results.
struct ResultDifference {
  std::vector<std::string> structure;  ///< sentences: other columns, times, bodies, arrays, an end before the other's
  std::vector<QuantityDifference> quantities;
  double largest() const;  ///< of QuantityDifference::relative
  bool exact() const;      ///< every number is the same
  std::size_t numbers() const;
};

/// Compares two directories of results: summary.json, every row of probes.csv, every array of every .vtu. Where one
/// ended before the other, the part that both have.
/// @throws FileError, InputError  where one is no result of this program, or damaged
ResultDifference compare_results(const std::filesystem::path& a, const std::filesystem::path& b);

nlohmann::ordered_json json_of(const ResultDifference& difference);

struct CompareOptions {
  std::filesystem::path a, b;
  double tolerance = 1e-6;
  bool json = false;
};

/// Prints how two results differ. @return kDone, or kDiffers above the tolerance or where their structure differs
int compare_command(const CompareOptions& options);

/// Prints a difference in words. @return whether it is within the tolerance
bool print_difference(const ResultDifference& difference, double tolerance);

/// summary.json of a directory of results. @throws FileError, InputError  where there is none
nlohmann::ordered_json read_summary(const std::filesystem::path& directory);

}  // namespace fascia::app
