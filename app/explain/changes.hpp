#pragma once

#include "app/explain/explanation.hpp"
#include "app/study/evaluation.hpp"

#include <filesystem>

namespace fascia::app {

/// Compares times of runs that were made in turns: the median of v / b of neighbours, and the extremes; 1 without any b
/// > 0.
Ratio ratio_of_pairs(const std::vector<double>& v, const std::vector<double>& b);

/// A ratio to one run of several that took so long: what it might have been beside the quickest and the slowest.
Ratio widened(const Ratio& ratio, const Spread& runs);

/// The probes of a scene's runs, and how far others are from them.
class VariantProbes {
 public:
  /// @param directory  of the base run
  VariantProbes(const Scene& scene, const RunRecord& base, const std::filesystem::path& directory);

  /// A probe that is 0 in the base run is compared with the largest of its kind.
  std::vector<ProbeChange> changes(const RunRecord& record, const std::filesystem::path& directory) const;

 private:
  struct Compared {
    StudyMeasure measure;
    RunMeasure base;
    double largest = 0;  ///< norm of the largest probe of the same quantity
  };
  std::vector<Compared> probes_;
};

}  // namespace fascia::app
