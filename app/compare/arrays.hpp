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

/// The sizes that quantities which ought to be zero are measured by.
struct Scales {
  double length = 0;   ///< the farthest point of a body [m]
  double modulus = 0;  ///< the largest stress over the largest strain [Pa]
};

/// The part of a field, or of a probe of that quantity, that rounding may leave; 0 where nothing is known of it.
double rounding_of(const std::string& quantity, const Scales& scales);

/// Prints a difference in words. @return whether it is within the tolerance
bool print_difference(const ResultDifference& difference, double tolerance);

/// summary.json of a directory of results. @throws FileError, InputError  where there is none
nlohmann::ordered_json read_summary(const std::filesystem::path& directory);

/// NAME.pvd; empty where nothing was saved. @throws InputError  states that it should list are there without it
std::filesystem::path collection_of(const std::filesystem::path& directory, const nlohmann::ordered_json& summary);

}  // namespace fascia::app
