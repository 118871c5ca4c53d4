#pragma once

#include "assembly/specification/scene.hpp"

#include <cstddef>
#include <string>
#include <vector>

/// Choices among the runs of a study that was made before.
namespace fascia::app {

/// A run of a study that may be what a scene needs.
struct StudiedRun {
  std::string label;                   ///< values of the axes
  std::vector<std::string> overrides;  ///< of the scene, "key.path=value"
  double error = 0;    ///< relative, the largest of the measures that count, with the uncertainty of their references
  double seconds = 0;  ///< set-up and solve, medians [s]
  double step = 0;     ///< median [s]
  double memory = 0;   ///< peak [bytes]
  double dofs = 0;
};

/// Runs of a study that are of a scene, and what is known of the others.
struct StoredStudy {
  std::vector<StudiedRun> runs;  ///< of this scene, converged and with an error; from cheap to dear
  std::size_t all = 0;           ///< that the study made
  std::size_t changing = 0;      ///< that change a key which the scene says
  std::size_t others = 0;        ///< that are of another scene in all else
  std::string measures;          ///< that count, in quotes: `"tip" and "end"`
  std::string source;            ///< of their references, in words
  bool same_machine = true;      ///< as this one: times hold
};

/// Reads the study that a scene's need names.
/// @throws SceneError  there is none, it does not measure what is needed, or none of its runs is of this scene
StoredStudy read_stored_study(const Scene& scene);

/// The runs to try, the best first: the cheapest that meets the need, then dearer ones whose steps are shorter. Where
/// no error is needed the most accurate comes first. Where none meets it, the nearest alone.
struct StudiedChoice {
  std::vector<std::size_t> runs;  ///< indices
  std::string why_not;            ///< empty: they meet the need
};
StudiedChoice choose_of_study(const StoredStudy& study, const StatedNeed& need);

}  // namespace fascia::app
