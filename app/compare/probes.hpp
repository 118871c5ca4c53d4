#pragma once

#include "app/compare/time_pairs.hpp"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace fascia::app {

/// A probe in two results, at one of its points, over all rows that are compared.
struct ProbeDifference {
  std::string name;  ///< "tip"; of a list of points "tip[3]"
  std::string unit;
  double relative = 0;       ///< largest / magnitude [-]; infinite where one has no value
  double largest = 0;        ///< of |a − b|, the Euclidean norm of vectors, the Frobenius norm of tensors
  double magnitude = 0;      ///< of |a|, |b|; the largest of both and of all rows
  double time = 0;           ///< of the largest difference
  std::vector<double> a, b;  ///< the values there
};

struct ProbeComparison {
  std::vector<ProbeDifference> probes;  ///< the largest `relative` first
  std::vector<std::string> structure, notes;
  bool same_rows = true;  ///< both have the same times
};

/// probes.csv of a result, as far as it is compared.
struct ProbeSource {
  std::filesystem::path directory;
  const nlohmann::ordered_json& summary;
  RunKind kind = RunKind::statics;
};

/// Compares the probes of two results by name. @throws FileError, InputError  see read_number_table()
ProbeComparison compare_probes(const ProbeSource& a, const ProbeSource& b);

}  // namespace fascia::app
