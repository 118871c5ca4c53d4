#pragma once

#include "app/compare/arrays.hpp"
#include "app/compare/fields.hpp"
#include "app/compare/figures.hpp"
#include "app/compare/probes.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// Two results beside one another.
struct Comparison {
  std::filesystem::path a, b;
  std::vector<std::string> structure;  ///< sentences: what cannot be compared
  std::vector<std::string> notes;      ///< sentences: how it was compared, and what was left out
  bool array_by_array = false;         ///< the meshes and times are the same, and `quantities` those of arrays
  bool exact = false;                  ///< then: every number is the same
  std::size_t numbers = 0;             ///< compared
  /// These count for the tolerance, the largest first: where meshes and times are the same every array, see
  /// compare_results(); else the fields and probes.
  std::vector<QuantityDifference> quantities;
  FieldComparison fields;
  ProbeComparison probes;
  std::vector<Figure> energies, costs;
  std::vector<Difference> settings, files, program;

  double largest() const { return quantities.empty() ? 0 : quantities.front().relative; }
  bool within(double tolerance) const { return structure.empty() && largest() <= tolerance; }
};

/// @param only  fields ("displacement", "liver: stress") and probes that count for the tolerance; empty: all
/// @throws FileError  no result of this program
/// @throws InputError  a damaged one, or `only` names nothing that both have
Comparison compare(const std::filesystem::path& a, const std::filesystem::path& b,
                   const std::vector<std::string>& only = {});

/// The fields of two results alone. @throws FileError, InputError  as compare()
FieldComparison compare_fields(const std::filesystem::path& a, const std::filesystem::path& b,
                               const FieldChoice& choice);

}  // namespace fascia::app
