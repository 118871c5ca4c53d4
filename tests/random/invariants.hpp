#pragma once

#include "tests/random/outcome.hpp"
#include "tests/random/random_scene.hpp"
#include "tests/random/scene_tree.hpp"
#include "tests/random/twins.hpp"

#include <string>
#include <vector>

namespace fascia::random_scenes {

/// A run ended in a way that scripts know, says why, and wrote finite numbers. @return  what is wrong, in words
std::vector<std::string> faults_of_end(const Outcome& run);

/// A scene that was made wrong on purpose is refused, by file, line and key.
std::vector<std::string> faults_of_refusal(const RandomScene& scene, const SceneText& text, const Outcome& run);

/// Balances and conservation laws that apply to a scene. @param checked  gets the names of those that were looked at
std::vector<std::string> faults_of_balance(const RandomScene& scene, const Outcome& run,
                                           std::vector<std::string>& checked);

/// How two runs of a scene compare.
struct Comparison {
  enum class Kind { agree, alike_failures, said, one_failed, differ } kind = Kind::agree;
  double worst = 0;  ///< the largest difference, relative to what is allowed
  std::string text;  ///< of differ and one_failed
};
Comparison compare(const RandomScene& scene, const Outcome& run, const Outcome& twin, const Frame& frame);

}  // namespace fascia::random_scenes
