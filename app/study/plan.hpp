#pragma once

#include "app/study/study_file.hpp"

#include <string>
#include <vector>

namespace fascia::app {

/// A combination of the axes' values.
struct PlannedRun {
  std::vector<std::size_t> at;         ///< index of each axis's value
  std::vector<std::string> overrides;  ///< of the base scene
  std::string refused;                 ///< why it is no valid scene; empty where it is one
  std::string key;                     ///< stands for everything that its result depends on
  std::string simulation;              ///< simulation_digest() of its scene
  std::string directory;               ///< of its results, within the study's
};

/// All combinations of a study, in the order of the axes (the last one changes fastest), or its pairs. Reference values
/// with units become SI.
/// @throws SceneError, FileError  the base scene is wrong
/// @throws InputError  none of the combinations is a valid scene; a probe, body or field that the scene has not, with
/// near ones
std::vector<PlannedRun> plan_study(Study& study);

/// A run of the base or another scene that gives a measure's reference. @param group  index of the value of
/// StudyMeasure::per, whose changes it has too
PlannedRun plan_reference(const Study& study, const StudyMeasure& measure, std::optional<std::size_t> group);

}  // namespace fascia::app
