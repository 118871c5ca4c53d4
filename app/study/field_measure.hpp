#pragma once

#include "app/study/study_file.hpp"

#include <array>
#include <filesystem>
#include <map>
#include <string>

namespace fascia::app {

/// How far a field at the end of a run is from that of another, both as functions of the rest position; of several
/// bodies over all of them, each by its volume.
struct FieldDistance {
  double error = 0;      ///< (∫ |u − v|² dV / ∫ |v|² dV)^½, v of the other run [-]
  double root_mean = 0;  ///< (∫ |u|² dV / V)^½, in the unit of the field
  std::string trouble;   ///< why there is none; empty where there is one
};

/// Distances of fields, each computed once: a study asks again whenever it has made a run.
class FieldDistances {
 public:
  /// @param directory, reference  of the two results
  const FieldDistance& at(const StudyMeasure& measure, const std::filesystem::path& directory,
                          const std::filesystem::path& reference);

 private:
  std::map<std::array<std::string, 4>, FieldDistance> known_;  ///< by field, body and both directories
};

}  // namespace fascia::app
